// What is not of this host: TLS and keys. The caller is Beast's own client, over OpenSSL.

#include <fstream>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <knurl/bridge/keys.hpp>

#include "../temp_folder.hpp"
#include "served.hpp"

namespace knurl::gateway {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace fs = std::filesystem;
using Stream = asio::ssl::stream<asio::ip::tcp::socket>;

/// A certificate that signs itself, with its key.
void make_certificate(const fs::path& certificate, const fs::path& key) {
    EVP_PKEY* pair = EVP_EC_gen("P-256");
    X509* made = X509_new();
    ASN1_INTEGER_set(X509_get_serialNumber(made), 1);
    X509_gmtime_adj(X509_getm_notBefore(made), 0);
    X509_gmtime_adj(X509_getm_notAfter(made), 3600);
    X509_set_pubkey(made, pair);
    X509_sign(made, pair, EVP_sha256());
    std::FILE* file = std::fopen(certificate.c_str(), "w");
    PEM_write_X509(file, made);
    std::fclose(file);
    file = std::fopen(key.c_str(), "w");
    ::fchmod(::fileno(file), 0600);
    PEM_write_PrivateKey(file, pair, nullptr, nullptr, 0, nullptr, nullptr);
    std::fclose(file);
    X509_free(made);
    EVP_PKEY_free(pair);
}

std::string text_of(const bridge::Key& key) {
    std::string text;
    for (const std::byte each : key.secret) {
        constexpr const char* digits = "0123456789abcdef";
        text += digits[std::to_integer<unsigned>(each) >> 4];
        text += digits[std::to_integer<unsigned>(each) & 15U];
    }
    return text;
}

class GatewayTls : public testing::Test {
  protected:
    GatewayTls() {
        make_certificate(options.certificate, options.private_key);
        for (const bridge::Key& each : {look, all}) bridge::add_key(options.keys, each);
    }
    Stream connect(std::uint16_t port) {
        Stream stream(io, tls);
        stream.next_layer().connect({asio::ip::address_v4::loopback(), port});
        stream.handshake(Stream::client);
        return stream;
    }
    http::response<http::string_body> ask(const Served& served, const std::string& target,
                                          const std::string& authorization = {},
                                          const std::string& cookie = {}) {
        Stream stream = connect(served.port);
        http::request<http::empty_body> request(http::verb::get, target, 11);
        request.set(http::field::host, served.host());
        if (!authorization.empty()) request.set(http::field::authorization, authorization);
        if (!cookie.empty()) request.set(http::field::cookie, cookie);
        http::write(stream, request);
        beast::flat_buffer buffer;
        http::response<http::string_body> response;
        http::read(stream, buffer, response);
        return response;
    }

    test::TempFolder folder;
    ServerOptions options{.certificate = folder.path() / "certificate",
                          .private_key = folder.path() / "key",
                          .keys = folder.path() / "keys"};
    bridge::Key look = bridge::make_key("look", bridge::Role::observe);
    bridge::Key all = bridge::make_key("all", bridge::Role::control);
    asio::io_context io;
    asio::ssl::context tls{asio::ssl::context::tls_client};
};

TEST_F(GatewayTls, KeyOpensWhatItsRoleMay) {
    const Served served(options, {}, "0.0.0.0");
    EXPECT_EQ(ask(served, "/").result_int(), 403U);
    EXPECT_EQ(ask(served, "/", "Bearer " + text_of(look)).body(), "page");
    EXPECT_EQ(ask(served, "/", "Bearer " + std::string(64, '0')).result_int(), 401U);
    EXPECT_EQ(ask(served, "/", "Basic " + text_of(look)).result_int(), 401U);

    const auto login = ask(served, "/?key=" + text_of(all));
    EXPECT_EQ(login.result_int(), 303U);
    const std::string cookie(login[http::field::set_cookie]);
    EXPECT_NE(cookie.find("; Secure"), std::string::npos) << cookie;
    EXPECT_EQ(ask(served, "/", {}, cookie.substr(0, cookie.find(';'))).body(), "page");
    EXPECT_EQ(ask(served, "/?key=" + std::string(64, '0')).result_int(), 403U);
    EXPECT_EQ(ask(served, "/?token=" + served.token).result_int(), 403U) << "tokens are of this host";
}

TEST_F(GatewayTls, SocketsNeedTheKeyEverywhere) {
    const Served served(options, {}, "0.0.0.0");
    const auto open = [&](const std::string& authorization) {
        beast::websocket::stream<Stream> socket(connect(served.port));
        socket.set_option(
            beast::websocket::stream_base::decorator([&](beast::websocket::request_type& request) {
                if (!authorization.empty()) request.set(http::field::authorization, authorization);
            }));
        boost::system::error_code error;
        socket.handshake(served.host(), "/open", error);  // on this host it needs none
        if (error) return std::string("refused");
        beast::flat_buffer buffer;
        socket.read(buffer);
        buffer.consume(buffer.size());
        const std::string message(70000, 'x');
        socket.write(asio::buffer(message));
        socket.read(buffer);
        EXPECT_EQ(beast::buffers_to_string(buffer.data()), message);
        socket.close(beast::websocket::close_code::normal, error);
        EXPECT_FALSE(error) << error.message();
        return std::string("open");
    };
    EXPECT_EQ(open({}), "refused");
    EXPECT_EQ(open("Bearer " + text_of(look)), "open");
}

TEST_F(GatewayTls, AKeyThatWasTakenOutOpensNothingAnyMoreAndItsSocketsAreClosed) {
    Served served(options, {}, "0.0.0.0");
    const auto socket_of = [&](const bridge::Key& key) {
        auto socket = std::make_unique<beast::websocket::stream<Stream>>(connect(served.port));
        socket->set_option(
            beast::websocket::stream_base::decorator([&](beast::websocket::request_type& request) {
                request.set(http::field::authorization, "Bearer " + text_of(key));
            }));
        socket->handshake(served.host(), "/open");
        beast::flat_buffer greeting;
        socket->read(greeting);
        return socket;
    };
    const auto read_keys_again = [&] {
        std::string why;
        served.in_server([&] {
            try {
                served.server().read_keys_again();
            } catch (const std::runtime_error& error) {
                why = error.what();
            }
        });
        return why;
    };
    const auto stays = socket_of(all), goes = socket_of(look);
    const auto login = ask(served, "/?key=" + text_of(look));
    const std::string cookie(login[http::field::set_cookie]);

    ::chmod(options.keys.c_str(), 0644);  // a file that cannot be used changes nothing
    EXPECT_NE(read_keys_again().find("chmod"), std::string::npos);
    EXPECT_EQ(ask(served, "/", "Bearer " + text_of(look)).body(), "page");

    std::filesystem::remove(options.keys);
    bridge::add_key(options.keys, all);
    EXPECT_EQ(read_keys_again(), "");
    EXPECT_EQ(ask(served, "/", "Bearer " + text_of(look)).result_int(), 401U);
    EXPECT_EQ(ask(served, "/", {}, cookie.substr(0, cookie.find(';'))).result_int(), 403U);
    beast::flat_buffer buffer;
    boost::system::error_code error;
    goes->read(buffer, error);
    EXPECT_EQ(error, beast::websocket::error::closed);
    EXPECT_EQ(goes->reason().reason, "its key is not admitted any more");
    stays->write(asio::buffer(std::string("still here")));
    stays->read(buffer);
    EXPECT_EQ(beast::buffers_to_string(buffer.data()), "still here");
}

TEST_F(GatewayTls, SpeaksNothingElse) {
    Served served(options, {}, "0.0.0.0");
    Caller plain(served.port);
    plain.send(served.request("GET /"));
    EXPECT_EQ(plain.read_to_the_end().find("HTTP"), std::string::npos);
    tls.set_options(asio::ssl::context::no_tlsv1_3);
    Stream stream(io, tls);
    stream.next_layer().connect({asio::ip::address_v4::loopback(), served.port});
    boost::system::error_code error;
    stream.handshake(Stream::client, error);
    EXPECT_TRUE(error) << "TLS 1.2";
}

TEST_F(GatewayTls, FilesThatCannotBeUsed) {
    const auto refused = [](const ServerOptions& with) -> std::string {
        try {
            const Server server(with);
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_EQ(refused(options), "accepted");
    ServerOptions half = options;
    half.private_key.clear();
    EXPECT_NE(refused(half).find("give both"), std::string::npos) << refused(half);
    ::chmod(options.private_key.c_str(), 0640);
    EXPECT_NE(refused(options).find("chmod 600"), std::string::npos) << refused(options);
    ::chmod(options.private_key.c_str(), 0600);
    std::swap(half.certificate, half.private_key);
    half = options;
    std::swap(half.certificate, half.private_key);
    ::chmod(half.private_key.c_str(), 0600);
    EXPECT_NE(refused(half).find("no certificate chain"), std::string::npos) << refused(half);
    half = options;
    half.keys = folder.path() / "missing";
    EXPECT_NE(refused(half).find("missing"), std::string::npos);
    std::ofstream(folder.path() / "empty") << "# none\n";
    ::chmod((folder.path() / "empty").c_str(), 0600);
    half.keys = folder.path() / "empty";
    EXPECT_NE(refused(half).find("holds no key"), std::string::npos) << refused(half);
}

}  // namespace

}  // namespace knurl::gateway
