#pragma once
// Two hosts in one machine: two network namespaces with a pair of veth between them. Where the right to make
// them is missing, or `ip`, both are this host, and why() says so.

#include <cstdint>
#include <string>

#include <knurl/shm/fd.hpp>

namespace knurl::bridge::test {

class TwoHosts {
  public:
    enum class Host : std::uint8_t { server, client };

    /// Bytes of an IP packet that each end of the wire carries. An end drops without a word what is longer
    /// and comes from the other: where they differ long datagrams vanish on their way to the narrower one.
    explicit TwoHosts(int server_mtu = 1500, int client_mtu = 1500);
    struct One {};
    explicit TwoHosts(One) : two_(false), why_("one was asked for") {}
    ~TwoHosts();
    TwoHosts(const TwoHosts&) = delete;
    TwoHosts& operator=(const TwoHosts&) = delete;

    bool two() const noexcept { return two_; }
    const std::string& why() const noexcept { return why_; }  // there are not two
    /// An end carries so many from now on. False: it could not be changed.
    bool narrow(Host host, int mtu);
    /// IPv4 of a host, as the other one reaches it.
    std::string address(Host host) const;

    /// While it lives, this thread, and what it starts, is on that host. File systems are shared as ever, so
    /// a servo's socket is seen from both; networks are not.
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
