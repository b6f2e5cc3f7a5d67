#pragma once

/// @file
/// knurl.live.v1, which the page of knurl-web speaks (README.md of this module has its messages). A LivePage makes the
/// texts of a tick once for all pages; each page has a handler of its own, with a claim of its own for what it adds.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <knurl/gateway/live_view.hpp>
#include <knurl/gateway/socket.hpp>

namespace knurl::gateway {

/// What a LivePage needs besides the view.
struct LivePageOptions {
    /// How a client connects to the servo: "knurl:default".
    std::string servo = "default";
    /// Folder for recordings on this host; empty: pages may not record.
    std::string recordings{};
    /// Path of the program `knurl`, for recordings and the doctor; empty: neither.
    std::string knurl_program{};
    /// One line for a log.
    std::function<void(const std::string&)> log{};
};

/// All pages of a servo.
class LivePage {
  public:
    /// `view` outlives it.
    LivePage(const LiveView& view, LivePageOptions options);
    ~LivePage();

    /// After LiveView::tick, once a tick.
    void tick(std::chrono::steady_clock::time_point now);
    /// Makes the handler of a page.
    std::unique_ptr<SocketHandler> open(Socket& socket);
    /// A file of a mesh from the page of that session, for its claim: begins to read it, and the page is told what became
    /// of it. `unit`: of its numbers, "mm"; empty: it is guessed. Throws std::runtime_error, one line.
    void take_mesh(const std::string& session, std::size_t device, const std::string& name,
                   const std::string& unit, std::string bytes);
    /// A mesh for the page, in the form of the README; none: it is not known.
    std::optional<std::string> asset(std::size_t device, std::uint64_t claim, std::uint32_t number) const;
    /// Pages that are open.
    std::size_t pages() const;

    /// What live_page.cpp has.
    struct Impl;

  private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::gateway
