#include "tls.hpp"

#include <cerrno>
#include <new>
#include <stdexcept>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>

#include <knurl/link/text.hpp>
#include <knurl/words/printable.hpp>

#include "system_text.hpp"
#include "tls_bio.hpp"

namespace knurl::bridge {

namespace {

struct Free {
    void operator()(SSL_CTX* p) const noexcept { SSL_CTX_free(p); }
    void operator()(SSL* p) const noexcept { SSL_free(p); }
    void operator()(SSL_SESSION* p) const noexcept { SSL_SESSION_free(p); }
};

const unsigned char* bytes_of(const std::byte* p) noexcept {
    return reinterpret_cast<const unsigned char*>(p);
}

/// OpenSSL takes an external PSK as a session to be resumed. Null: out of memory.
SSL_SESSION* session_of(SSL* ssl, const std::array<std::byte, key_bytes>& secret) noexcept {
    constexpr unsigned char chacha20_poly1305_sha256[] = {0x13, 0x03};
    std::unique_ptr<SSL_SESSION, Free> session(SSL_SESSION_new());
    const SSL_CIPHER* cipher = SSL_CIPHER_find(ssl, chacha20_poly1305_sha256);
    if (!session || !cipher ||
        SSL_SESSION_set1_master_key(session.get(), bytes_of(secret.data()), secret.size()) != 1 ||
        SSL_SESSION_set_cipher(session.get(), cipher) != 1 ||
        SSL_SESSION_set_protocol_version(session.get(), TLS1_3_VERSION) != 1)
        return nullptr;
    return session.release();
}

/// A name from the other side, made safe for a log line.
std::string in_quotes(std::string_view name) {
    return detail::format("'{}'", words::printable(name, max_key_name));
}

/// An alert from the peer has the reason 1000 + its number (RFC 8446, 6).
bool is_alert(unsigned long error) {
    return error != 0 && ERR_GET_REASON(error) >= SSL_AD_REASON_OFFSET;
}

}  // namespace

struct TlsContext::Impl {
    std::unique_ptr<SSL_CTX, Free> ctx;
    bool server = false;
    std::vector<Key> keys;  // a client has one
    Key decoy;              // server: the key for unknown names
};

struct TlsSession::Impl {
    std::shared_ptr<const TlsContext> context;
    std::unique_ptr<SSL, Free> ssl;
    SocketBio socket;
    std::string identity;  // from the client
    bool known = false;    // server: a key has this name
    bool done = false;
    bool wants_write = false;
    std::string reason;
    bool about_keys = false;

    bool server() const noexcept { return context->impl_->server; }
    Io judge(int result) noexcept;
    void explain(unsigned long error) noexcept;
    std::string sentence(unsigned long error);
    std::string why_it_ended(const std::string& detail) const;
    std::string why_the_client_failed(unsigned long error, const std::string& detail) const;
    std::string why_the_server_failed(unsigned long error, const std::string& detail);

    static int use_key(SSL* ssl, const EVP_MD* md, const unsigned char** name, std::size_t* bytes,
                       SSL_SESSION** session) noexcept;
    static int find_key_of(SSL* ssl, const unsigned char* name, std::size_t bytes,
                           SSL_SESSION** session) noexcept;
};

int TlsSession::Impl::use_key(SSL* ssl, const EVP_MD* md, const unsigned char** name, std::size_t* bytes,
                              SSL_SESSION** session) noexcept {
    const auto* self = static_cast<const Impl*>(SSL_get_app_data(ssl));
    const Key& key = self->context->impl_->keys.front();
    *session = nullptr;
    if (md != nullptr && EVP_MD_get_type(md) != NID_sha256) return 1;  // no key for that hash
    *session = session_of(ssl, key.secret);
    *name = reinterpret_cast<const unsigned char*>(key.name.data());
    *bytes = key.name.size();
    return *session != nullptr;
}

/// An unknown name is checked against a secret that nobody has, so it fails like a wrong secret. A stranger
/// does not learn which names exist.
int TlsSession::Impl::find_key_of(SSL* ssl, const unsigned char* name, std::size_t bytes,
                                  SSL_SESSION** session) noexcept {
    auto* self = static_cast<Impl*>(SSL_get_app_data(ssl));
    const TlsContext::Impl& context = *self->context->impl_;
    const std::string_view identity(reinterpret_cast<const char*>(name), bytes);
    const Key* key = find_key(context.keys, identity);
    self->known = key != nullptr;
    self->identity = identity.substr(0, max_key_name + 1);
    *session = session_of(ssl, (key ? *key : context.decoy).secret);
    return *session != nullptr;
}

TlsContext::TlsContext(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TlsContext::~TlsContext() = default;

namespace {

std::unique_ptr<SSL_CTX, Free> make_context(const SSL_METHOD* method) {
    std::unique_ptr<SSL_CTX, Free> ctx(SSL_CTX_new(method));
    if (!ctx) throw std::bad_alloc();
    if (SSL_CTX_set_min_proto_version(ctx.get(), TLS1_3_VERSION) != 1 ||
        SSL_CTX_set_max_proto_version(ctx.get(), TLS1_3_VERSION) != 1 ||
        SSL_CTX_set_ciphersuites(ctx.get(), "TLS_CHACHA20_POLY1305_SHA256") != 1)
        throw std::runtime_error(
            "this OpenSSL has no TLS 1.3 with ChaCha20-Poly1305, which the bridge needs");
    SSL_CTX_set_options(ctx.get(), SSL_OP_NO_TICKET);
    SSL_CTX_set_num_tickets(ctx.get(), 0);
    SSL_CTX_set_session_cache_mode(ctx.get(), SSL_SESS_CACHE_OFF);
    SSL_CTX_set_mode(ctx.get(), SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
    return ctx;
}

}  // namespace

std::shared_ptr<const TlsContext> TlsContext::client(Key key) {
    auto impl = std::make_unique<Impl>();
    impl->ctx = make_context(TLS_client_method());
    // No certificate is trusted, so an end without the key cannot use one instead.
    SSL_CTX_set_verify(impl->ctx.get(), SSL_VERIFY_PEER, nullptr);
    SSL_CTX_set_psk_use_session_callback(impl->ctx.get(), TlsSession::Impl::use_key);
    impl->keys.push_back(std::move(key));
    return std::shared_ptr<const TlsContext>(new TlsContext(std::move(impl)));
}

std::shared_ptr<const TlsContext> TlsContext::server(std::vector<Key> keys) {
    auto impl = std::make_unique<Impl>();
    impl->ctx = make_context(TLS_server_method());
    impl->server = true;
    SSL_CTX_set_psk_find_session_callback(impl->ctx.get(), TlsSession::Impl::find_key_of);
    impl->keys = std::move(keys);
    impl->decoy = make_key("nobody", Role::observe);
    return std::shared_ptr<const TlsContext>(new TlsContext(std::move(impl)));
}

TlsSession::TlsSession(std::shared_ptr<const TlsContext> context, int fd) : impl_(std::make_unique<Impl>()) {
    impl_->context = std::move(context);
    impl_->ssl.reset(SSL_new(impl_->context->impl_->ctx.get()));
    if (!impl_->ssl) throw std::bad_alloc();
    impl_->socket.fd = fd;
    BIO* bio = make_socket_bio(impl_->socket);
    SSL_set_bio(impl_->ssl.get(), bio, bio);
    SSL_set_app_data(impl_->ssl.get(), impl_.get());
    if (impl_->server())
        SSL_set_accept_state(impl_->ssl.get());
    else
        SSL_set_connect_state(impl_->ssl.get());
}

TlsSession::~TlsSession() = default;
TlsSession::TlsSession(TlsSession&&) noexcept = default;
TlsSession& TlsSession::operator=(TlsSession&&) noexcept = default;

TlsSession::Io TlsSession::Impl::judge(int result) noexcept {
    const int error = SSL_get_error(ssl.get(), result);
    wants_write = error == SSL_ERROR_WANT_WRITE;
    switch (error) {
        case SSL_ERROR_NONE:
            return Io::done;
        case SSL_ERROR_WANT_READ:
        case SSL_ERROR_WANT_WRITE:
            return Io::again;
        case SSL_ERROR_ZERO_RETURN:
            return Io::closed;
        default:
            break;
    }
    const unsigned long first = ERR_get_error();
    ERR_clear_error();
    explain(first);
    return Io::failed;
}

void TlsSession::Impl::explain(unsigned long error) noexcept try {
    reason = sentence(error);
} catch (const std::bad_alloc&) {
    reason.clear();
}

std::string TlsSession::Impl::sentence(unsigned long error) {
    const char* openssl = ERR_reason_error_string(error);
    const std::string detail = openssl ? " (" + std::string(openssl) + ")" : "";
    if (done) return why_it_ended(detail);
    return server() ? why_the_client_failed(error, detail) : why_the_server_failed(error, detail);
}

std::string TlsSession::Impl::why_it_ended(const std::string& detail) const {
    if (socket.error != 0) return "the connection broke: " + system_text(socket.error);
    if (socket.ended) return "the connection ended without a goodbye: the peer died, or somebody cut it";
    return "TLS failed: damaged or foreign bytes in the connection" + detail;
}

std::string TlsSession::Impl::why_the_client_failed(unsigned long error, const std::string& detail) const {
    if (socket.spoke && !socket.began_as_tls())
        return "the peer does not speak TLS, and this bridge wants a key; set KNURL_KEY at the peer";
    const bool wrong_secret = ERR_GET_REASON(error) == SSL_R_BINDER_DOES_NOT_VERIFY;
    if (wrong_secret && !known)
        return "no key is named " + in_quotes(identity) + "; add it to the keys file, or correct the peer's";
    if (wrong_secret)
        return "the peer's key " + in_quotes(identity) +
               " has another secret than the keys file; copy its line again";
    if (socket.ended || socket.error != 0) return "the peer hung up in the handshake";
    if (is_alert(error)) return "the peer refused the handshake" + detail;
    if (identity.empty()) return "the peer offered no key" + detail;
    return "the TLS handshake failed" + detail;
}

std::string TlsSession::Impl::why_the_server_failed(unsigned long error, const std::string& detail) {
    const std::string name = in_quotes(context->impl_->keys.front().name);
    about_keys = true;
    if (is_alert(error))
        return "the bridge refused the key " + name +
               ": its keys file has no such name, or another secret under it" + detail;
    if (socket.spoke && !socket.began_as_tls())
        return "the other end does not speak TLS: no bridge, or one without keys (then leave KNURL_KEY "
               "unset)";
    if (socket.ended || socket.error != 0) {
        about_keys = false;
        return "the other end hung up in the handshake: no bridge, or it is full";
    }
    return "the other end does not hold the key " + name + ": it is not the bridge that this key is for" +
           detail;
}

TlsSession::Io TlsSession::handshake() noexcept {
    if (impl_->done) return Io::done;
    ERR_clear_error();
    const Io io = impl_->judge(SSL_do_handshake(impl_->ssl.get()));
    if (io == Io::failed && impl_->server() && impl_->socket.spoke && !impl_->socket.began_as_tls()) {
        // OpenSSL sends nothing to a peer that does not speak TLS. One alert tells a plain client why it is
        // refused.
        constexpr unsigned char handshake_failure[] = {21, 3, 3, 0, 2, 2, 40};
        [[maybe_unused]] const ssize_t sent = ::send(impl_->socket.fd, handshake_failure,
                                                     sizeof handshake_failure, MSG_NOSIGNAL | MSG_DONTWAIT);
    }
    if (io != Io::done) return io;
    // Without this check, an end that got OpenSSL to accept it without the key would pass.
    if (SSL_session_reused(impl_->ssl.get()) != 1) {
        impl_->explain(0);
        return Io::failed;
    }
    impl_->done = true;
    return Io::done;
}

TlsSession::Moved TlsSession::read(std::span<std::byte> into) noexcept {
    ERR_clear_error();
    std::size_t bytes = 0;
    const int result = SSL_read_ex(impl_->ssl.get(), into.data(), into.size(), &bytes);
    const Io io = result == 1 ? Io::done : impl_->judge(result);
    return {.io = io, .bytes = bytes};
}

TlsSession::Moved TlsSession::write(std::span<const std::byte> from) noexcept {
    ERR_clear_error();
    std::size_t bytes = 0;
    const int result = SSL_write_ex(impl_->ssl.get(), from.data(), from.size(), &bytes);
    const Io io = result == 1 ? Io::done : impl_->judge(result);
    if (result == 1) impl_->wants_write = false;
    return {.io = io, .bytes = bytes};
}

void TlsSession::close() noexcept {
    ERR_clear_error();
    if (impl_->done) SSL_shutdown(impl_->ssl.get());
    ERR_clear_error();
}

bool TlsSession::wants_write() const noexcept {
    return impl_->wants_write;
}

std::size_t TlsSession::pending() const noexcept {
    return static_cast<std::size_t>(SSL_pending(impl_->ssl.get()));
}

std::string_view TlsSession::peer_identity() const noexcept {
    return impl_->done ? std::string_view(impl_->identity) : std::string_view();
}

bool TlsSession::known_key() const noexcept {
    return impl_->known;
}

bool TlsSession::export_keys(std::string_view label, DirectionKeys& out) const noexcept {
    if (!impl_->done) return false;
    std::array<unsigned char, 2 * key_bytes> both{};  // client to server, server to client
    if (SSL_export_keying_material(impl_->ssl.get(), both.data(), both.size(), label.data(), label.size(),
                                   nullptr, 0, 0) != 1)
        return false;
    auto& first = impl_->server() ? out.receive : out.send;
    auto& second = impl_->server() ? out.send : out.receive;
    for (std::size_t i = 0; i < key_bytes; ++i) {
        first[i] = std::byte{both[i]};
        second[i] = std::byte{both[key_bytes + i]};
    }
    OPENSSL_cleanse(both.data(), both.size());
    return true;
}

const std::string& TlsSession::reason() const noexcept {
    return impl_->reason;
}

bool TlsSession::about_keys() const noexcept {
    return impl_->about_keys;
}

}  // namespace knurl::bridge
