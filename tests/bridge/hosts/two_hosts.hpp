#pragma once
// Two hosts in one machine: two network namespaces with a pair of veth between them. Without the right to
// create them, or without `ip`, both are this host, and why() gives the reason.

#include <cstdint>
#include <string>

#include <knurl/shm/fd.hpp>

namespace knurl::bridge::test {

class TwoHosts {
  public:
    enum class Host : std::uint8_t { server, client };

    /// Bytes of an IP packet that each end of the wire carries. An end silently drops longer packets from the
    /// other: with different values long datagrams vanish on their way to the narrower one.
    explicit TwoHosts(int server_mtu = 1500, int client_mtu = 1500);
    struct One {};
    explicit TwoHosts(One) : two_(false), why_("one was asked for") {}
    ~TwoHosts();
    TwoHosts(const TwoHosts&) = delete;
    TwoHosts& operator=(const TwoHosts&) = delete;

    bool two() const noexcept { return two_; }
    const std::string& why() const noexcept { return why_; }  // there are not two
    /// Changes what an end carries from now on. False: it could not be changed.
    bool narrow(Host host, int mtu);
    /// IPv4 of a host, as the other one reaches it.
    std::string address(Host host) const;

    /// While it lives, this thread and its children are on that host. File systems are shared, so both see a
    /// servo's socket; networks are separate.
    class On {
      public:
        On(const TwoHosts& hosts, Host host);
        ~On();
        On(const On&) = delete;
        On& operator=(const On&) = delete;

      private:
        shm::UniqueFd before_;
    };

  private:
    void run(const std::string& command);
    void give_up(const std::string& why);
    std::string name(Host host) const;

    bool two_ = true;
    std::string why_, base_;
    int net_ = 0;
    shm::UniqueFd spaces_[2];
};

}  // namespace knurl::bridge::test
