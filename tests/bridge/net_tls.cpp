// Which peers are admitted, which are refused, and each side's message about it.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <openssl/evp.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include "net_pair.hpp"

namespace knurl::bridge::test {
namespace {

Key key_of(std::string name, int secret) {
    Key key{.name = std::move(name), .role = Role::control};
    key.secret.fill(static_cast<std::byte>(secret));
    return key;
}

/// Serves both ends until each is open or closed.
void settle(Pair& pair) {
    const auto settled = [](const FrameStream& s) { return s.state() != FrameStream::State::handshaking; };
    EXPECT_TRUE(serve({&pair.client, &pair.server}, [&] {
        take_all(pair.client);  // a client learns by its first read whether the server accepts its key
        take_all(pair.server);
        return settled(pair.client) && is_closed(pair.server);
    }));
    EXPECT_TRUE(serve({&pair.client}, [&] {
        take_all(pair.client);
        return is_closed(pair.client);
    }));
}

TEST(Tls, BothEndsHoldTheSameKeyAndDeriveTheSameTwoKeys) {
    Pair pair(TlsContext::client(key_of("lab", 1)), TlsContext::server({key_of("a", 2), key_of("lab", 1)}));
    EXPECT_FALSE(pair.client.export_keys("knurl datagrams")) << "not before the handshake is done";
    ASSERT_TRUE(pair.open());
    EXPECT_EQ(pair.server.peer_identity(), "lab");
    EXPECT_EQ(pair.client.peer_identity(), "");
    const auto client = pair.client.export_keys("knurl datagrams");
    const auto server = pair.server.export_keys("knurl datagrams");
    ASSERT_TRUE(client && server);
    EXPECT_EQ(client->send, server->receive);
    EXPECT_EQ(client->receive, server->send);
    EXPECT_NE(client->send, client->receive);
    EXPECT_NE(pair.client.export_keys("another label")->send, client->send);
}

TEST(Tls, ANewConnectionHasNewKeys) {
    const auto client = TlsContext::client(key_of("lab", 1));
    const auto server = TlsContext::server({key_of("lab", 1)});
    Pair first(client, server), second(client, server);
    ASSERT_TRUE(first.open() && second.open());
    EXPECT_NE(first.client.export_keys("x")->send, second.client.export_keys("x")->send);
}

TEST(Tls, WithoutItThereAreNoKeys) {
    Pair pair;
    ASSERT_TRUE(pair.open());
    EXPECT_FALSE(pair.client.export_keys("knurl datagrams"));
}

TEST(Tls, AWrongSecretIsRefusedAndBothSidesSayWhatToMend) {
    Pair pair(TlsContext::client(key_of("lab", 1)), TlsContext::server({key_of("lab", 2)}));
    settle(pair);
    EXPECT_EQ(pair.server.reason(),
              "the peer's key 'lab' has another secret than the keys file; copy its line again");
    EXPECT_THAT(pair.client.reason(),
                testing::StartsWith("the bridge refused the key 'lab': its keys file has no such "
                                    "name, or another secret under it"));
}

TEST(Tls, AnUnknownNameLooksToTheStrangerLikeAWrongSecret) {
    Pair unknown(TlsContext::client(key_of("stranger", 1)), TlsContext::server({key_of("lab", 1)}));
    settle(unknown);
    EXPECT_EQ(unknown.server.reason(),
              "no key is named 'stranger'; add it to the keys file, or correct the peer's");
    Pair wrong(TlsContext::client(key_of("stranger", 1)), TlsContext::server({key_of("stranger", 2)}));
    settle(wrong);
    EXPECT_EQ(unknown.client.reason(), wrong.client.reason());
}

TEST(Tls, NamesFromStrangersAreFitForALog) {
    Key key = key_of("lab\n\x1b[2J" + std::string(100, 'x'), 1);
    Pair pair(TlsContext::client(key), TlsContext::server({key_of("lab", 1)}));
    settle(pair);
    EXPECT_THAT(pair.server.reason(), testing::StartsWith("no key is named 'lab??[2Jxxx"));
    EXPECT_LT(pair.server.reason().size(), 200u);
}

TEST(Tls, AClientWithoutAKeyIsToldThatItNeedsOne) {
    Pair pair(nullptr, TlsContext::server({key_of("lab", 1)}));
    pair.client.send(1, 0, bytes_of("hello, plainly"));
    settle(pair);
    EXPECT_EQ(pair.client.reason(), "the bridge wants a key; set KNURL_KEY to a file that holds yours");
    EXPECT_EQ(pair.server.reason(),
              "the peer does not speak TLS, and this bridge wants a key; set KNURL_KEY at the peer");
}

TEST(Tls, AClientWithAKeyAtABridgeWithoutIsTold) {
    Pair pair(TlsContext::client(key_of("lab", 1)), nullptr);
    EXPECT_TRUE(serve({&pair.client, &pair.server}, [&] {
        take_all(pair.server);
        return is_closed(pair.server);
    }));
    EXPECT_EQ(pair.server.reason(),
              "the peer uses a key, and this bridge has none; start it with --keys, or leave "
              "KNURL_KEY unset at the peer");
    ::shutdown(pair.server.fd(), SHUT_RDWR);
    EXPECT_TRUE(serve({&pair.client}, [&] { return is_closed(pair.client); }));
    EXPECT_EQ(pair.client.reason(),
              "the other end does not speak TLS: no bridge, or one without keys (then leave KNURL_KEY "
              "unset)");
    EXPECT_EQ(pair.client.how_it_ended(), FrameStream::End::keys) << "trying again changes nothing";
}

TEST(Tls, ABridgeThatHangsUpInTheHandshakeIsNoMatterOfKeys) {
    Pair pair(TlsContext::client(key_of("lab", 1)), nullptr);
    ::shutdown(pair.server.fd(), SHUT_RDWR);
    EXPECT_TRUE(serve({&pair.client}, [&] { return is_closed(pair.client); }));
    EXPECT_EQ(pair.client.reason(), "the other end hung up in the handshake: no bridge, or it is full");
    EXPECT_EQ(pair.client.how_it_ended(), FrameStream::End::broken) << "it may be restarting";
}

/// A server that ignores the client's key and shows a self-made certificate.
TEST(Tls, ACertificateInsteadOfTheKeyIsRefused) {
    SSL_CTX* ctx = SSL_CTX_new(TLS_server_method());
    EVP_PKEY* pkey = EVP_EC_gen("P-256");
    X509* certificate = X509_new();
    X509_gmtime_adj(X509_getm_notBefore(certificate), 0);
    X509_gmtime_adj(X509_getm_notAfter(certificate), 3600);
    X509_set_pubkey(certificate, pkey);
    X509_sign(certificate, pkey, EVP_sha256());
    ASSERT_EQ(SSL_CTX_use_certificate(ctx, certificate), 1);
    ASSERT_EQ(SSL_CTX_use_PrivateKey(ctx, pkey), 1);
    Sockets sockets = connected_sockets();
    FrameStream client(std::move(sockets.client), false, TlsContext::client(key_of("lab", 1)));
    SSL* ssl = SSL_new(ctx);
    SSL_set_fd(ssl, sockets.server.get());
    ::fcntl(sockets.server.get(), F_SETFL, O_NONBLOCK);
    for (int rounds = 0; rounds < 1000 && !is_closed(client); ++rounds) {
        client.pump();
        SSL_accept(ssl);
        pollfd socket{.fd = client.fd(), .events = POLLIN, .revents = 0};
        ::poll(&socket, 1, 10);
    }
    EXPECT_THAT(client.reason(), testing::StartsWith("the other end does not hold the key 'lab'"));
    SSL_free(ssl);
    X509_free(certificate);
    EVP_PKEY_free(pkey);
    SSL_CTX_free(ctx);
}

TEST(Tls, OlderVersionsAreNotSpoken) {
    SSL_CTX* ctx = SSL_CTX_new(TLS_client_method());
    SSL_CTX_set_max_proto_version(ctx, TLS1_2_VERSION);
    Sockets sockets = connected_sockets();
    FrameStream server(std::move(sockets.server), true, TlsContext::server({key_of("lab", 1)}));
    SSL* ssl = SSL_new(ctx);
    ::fcntl(sockets.client.get(), F_SETFL, O_NONBLOCK);
    SSL_set_fd(ssl, sockets.client.get());
    SSL_connect(ssl);
    EXPECT_TRUE(serve({&server}, [&] { return is_closed(server); }));
    EXPECT_THAT(server.reason(), testing::HasSubstr("unsupported protocol"));
    SSL_free(ssl);
    SSL_CTX_free(ctx);
}

TEST(Tls, ADamagedByteEndsTheConnectionAndNothingOfItIsGiven) {
    const Key key = key_of("lab", 1);
    Sockets left = connected_sockets(), right = connected_sockets();
    FrameStream client(std::move(left.client), false, TlsContext::client(key));
    FrameStream server(std::move(right.server), true, TlsContext::server({key}));
    // The test carries the bytes between the two ends.
    const auto carry = [](int from, int to, bool damage) {
        std::array<char, 4096> bytes;
        const ssize_t got = ::recv(from, bytes.data(), bytes.size(), MSG_DONTWAIT);
        if (got <= 0) return;
        if (damage) bytes[static_cast<std::size_t>(got) - 1] ^= 1;
        EXPECT_EQ(::send(to, bytes.data(), static_cast<std::size_t>(got), MSG_NOSIGNAL), got);
    };
    for (int rounds = 0; rounds < 100'000 && !(is_open(client) && is_open(server)); ++rounds) {
        client.pump();
        server.pump();
        carry(left.server.get(), right.client.get(), false);
        carry(right.client.get(), left.server.get(), false);
    }
    ASSERT_TRUE(is_open(client) && is_open(server));
    client.send(1, 0, bytes_of("pay 100"));
    pollfd wire{.fd = left.server.get(), .events = POLLIN, .revents = 0};
    ASSERT_EQ(::poll(&wire, 1, 1000), 1);
    carry(left.server.get(), right.client.get(), true);
    EXPECT_TRUE(serve({&server}, [&] { return is_closed(server); }));
    EXPECT_TRUE(take_all(server).empty());
    EXPECT_THAT(server.reason(), testing::StartsWith("TLS failed: damaged or foreign bytes"));
}

TEST(Tls, AConnectionThatWasCutIsToldFromOneThatEnded) {
    Pair pair = encrypted_pair();
    ASSERT_TRUE(pair.open());
    ::shutdown(pair.server.fd(), SHUT_RDWR);
    EXPECT_TRUE(serve({&pair.client}, [&] { return is_closed(pair.client); }));
    EXPECT_EQ(pair.client.reason(),
              "the connection ended without a goodbye: the peer died, or somebody cut it");
}

}  // namespace
}  // namespace knurl::bridge::test
