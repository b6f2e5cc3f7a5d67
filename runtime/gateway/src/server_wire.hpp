#pragma once
// One connection's bytes, with TLS or without: Beast is compiled once for both, and any stream socket will do (a test
// gives one of a pair).

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <boost/asio/bind_executor.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace knurl::gateway {

namespace asio = boost::asio;
namespace beast = boost::beast;

class Wire {
  public:
    using executor_type = asio::io_context::executor_type;
    using Plain = asio::basic_stream_socket<asio::generic::stream_protocol, executor_type>;
    using Tls = asio::ssl::stream<Plain&>;

    Wire(asio::io_context& io, asio::ssl::context* tls) : all_(std::make_unique<All>(io)) {
        if (tls) all_->tls.emplace(all_->plain, *tls);
    }

    executor_type get_executor() { return all_->plain.get_executor(); }
    Plain& plain() { return all_->plain; }
    bool secret() const { return all_->tls.has_value(); }
    Tls& tls() { return *all_->tls; }
    /// Bytes that were read too early: they come first.
    void unread(std::string bytes) { all_->unread = std::move(bytes); }
    void close() noexcept {
        boost::system::error_code ignored;
        all_->plain.close(ignored);
    }

    template <class Buffers, class Token>
    auto async_read_some(const Buffers& buffers, Token&& token) {
        return asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
            [all = all_.get()](auto handler, const Buffers& to) {
                if (!all->unread.empty()) {
                    const std::size_t size = asio::buffer_copy(to, asio::buffer(all->unread));
                    all->unread.erase(0, size);
                    asio::post(
                        all->plain.get_executor(),
                        beast::bind_front_handler(std::move(handler), boost::system::error_code(), size));
                } else if (all->tls) {
                    all->tls->async_read_some(to, std::move(handler));
                } else {
                    all->plain.async_read_some(to, std::move(handler));
                }
            },
            token, buffers);
    }
    template <class Buffers, class Token>
    auto async_write_some(const Buffers& buffers, Token&& token) {
        return asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
            [all = all_.get()](auto handler, const Buffers& from) {
                if (all->tls)
                    all->tls->async_write_some(from, std::move(handler));
                else
                    all->plain.async_write_some(from, std::move(handler));
            },
            token, buffers);
    }

  private:
    struct All {
        explicit All(asio::io_context& io) : plain(io) {}
        Plain plain;
        std::optional<Tls> tls;
        std::string unread;
    };
    std::unique_ptr<All> all_;  // TLS refers to the socket, so it stays where it is
};

// What Beast calls at the end of a WebSocket.
inline void beast_close_socket(Wire& wire) {
    wire.close();
}
inline void teardown(beast::role_type role, Wire& wire, boost::system::error_code& error) {
    beast::websocket::teardown(role, wire.plain(), error);
}
template <class Handler>
void async_teardown(beast::role_type role, Wire& wire, Handler&& handler) {
    if (wire.secret())
        beast::async_teardown(role, wire.tls(), std::forward<Handler>(handler));
    else
        beast::websocket::async_teardown(role, wire.plain(), std::forward<Handler>(handler));
}

}  // namespace knurl::gateway
