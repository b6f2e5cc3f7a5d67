// Wrong handles, null pointers and sizes; threads; and ten thousand connections.

#include <random>
#include <thread>

#include <dirent.h>
#include <generators.hpp>
#include <sys/syscall.h>
#include <unistd.h>

#include "e2e_support.hpp"

namespace capi_test {
namespace {

/// Everything that a call on a hand may be given, all of it legal.
struct Given {
    knurl_report report = sized<knurl_report>();
    knurl_frame frame = sized<knurl_frame>();
    knurl_feedback feedback = sized<knurl_feedback>();
    knurl_network network = sized<knurl_network>();
    knurl_device device = sized<knurl_device>();
    knurl_limits limits = sized<knurl_limits>();
    knurl_timing timing = sized<knurl_timing>();
    knurl_followed followed = sized<knurl_followed>();
    knurl_sent sent = sized<knurl_sent>();
    knurl_plane floor = plane(-1, 100);
    knurl_mesh mesh = sized<knurl_mesh>();
    knurl_heights heights = sized<knurl_heights>();
    knurl_sending* sending = nullptr;
    knurl_hand* hand = nullptr;
    knurl_vec3 vector{};
    std::uint32_t connected = 0;
    std::uint64_t number = 0;
    std::int64_t age = 0, uncertainty = 0;
    std::int32_t pid = 0;
    std::size_t count = 0;
    double stiffness = 0;
    int fd = 0;
    knurl_id id = 0;
    std::vector<std::array<double, 3>> vertices{{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}};
    std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}};
    std::vector<float> z = std::vector<float>(4, 0.0f);

    Given() {
        mesh.vertices = vertices[0].data();
        mesh.vertex_count = 3;
        mesh.triangles = triangles[0].data();
        mesh.triangle_count = 1;
        heights.heights_float = z.data();
        heights.columns = heights.rows = 2;
        heights.dx = heights.dy = 0.01;
    }
};

int flat_model(void*, const knurl_vec3* near, knurl_surface_point* out) {
    out->foot = {near->x, near->y, -1};
    out->normal = {0, 0, 1};
    return 0;
}

struct Call {
    const char* name;
    std::function<int(knurl_hand*, Given&)> make;
};
/// Each function that takes a hand.
const Call of_a_hand[] = {
    {"newest", [](knurl_hand* h, Given& g) { return knurl_newest(h, 0, &g.frame); }},
    {"latest", [](knurl_hand* h, Given& g) { return knurl_latest(h, &g.report); }},
    {"next_report", [](knurl_hand* h, Given& g) { return knurl_next_report(h, 0, &g.report); }},
    {"reports", [](knurl_hand* h, Given& g) { return knurl_reports(h, &g.report, 1, &g.count); }},
    {"fd", [](knurl_hand* h, Given& g) { return knurl_fd(h, &g.fd); }},
    {"missed", [](knurl_hand* h, Given& g) { return knurl_missed(h, &g.number); }},
    {"reattachments", [](knurl_hand* h, Given& g) { return knurl_reattachments(h, &g.number); }},
    {"device_of", [](knurl_hand* h, Given& g) { return knurl_device_of(h, &g.device); }},
    {"age", [](knurl_hand* h, Given& g) { return knurl_age(h, 0, &g.age, &g.uncertainty); }},
    {"network_of", [](knurl_hand* h, Given& g) { return knurl_network_of(h, &g.network); }},
    {"add", [](knurl_hand* h, Given& g) { return knurl_add(h, KNURL_PLANE, &g.floor, nullptr, &g.id); }},
    {"set", [](knurl_hand* h, Given& g) { return knurl_set(h, g.id, KNURL_PLANE, &g.floor); }},
    {"get", [](knurl_hand* h, Given& g) { return knurl_get(h, g.id, KNURL_PLANE, &g.floor); }},
    {"feedback_of", [](knurl_hand* h, Given& g) { return knurl_feedback_of(h, g.id, &g.feedback); }},
    {"applied_stiffness",
     [](knurl_hand* h, Given& g) { return knurl_applied_stiffness(h, g.id, &g.stiffness); }},
    {"follow",
     [](knurl_hand* h, Given& g) { return knurl_follow(h, g.id, flat_model, nullptr, 0, &g.followed); }},
    {"remove", [](knurl_hand* h, Given& g) { return knurl_remove(h, g.id); }},
    {"place_probe", [](knurl_hand* h, Given& g) { return knurl_place_probe(h, 1, &g.vector, 0); }},
    {"begin_group", [](knurl_hand* h, Given&) { return knurl_begin_group(h); }},
    {"cancel_group", [](knurl_hand* h, Given&) { return knurl_cancel_group(h); }},
    {"end_group", [](knurl_hand* h, Given&) { return knurl_begin_group(h) + knurl_end_group(h); }},
    {"arm", [](knurl_hand* h, Given&) { return knurl_arm(h); }},
    {"disarm", [](knurl_hand* h, Given&) { return knurl_disarm(h); }},
    {"commit", [](knurl_hand* h, Given& g) { return knurl_commit(h, &g.number); }},
    {"wait_applied", [](knurl_hand* h, Given&) { return knurl_wait_applied(h, 0, 20 * s); }},
    {"keep_alive", [](knurl_hand* h, Given&) { return knurl_keep_alive(h, -1); }},
    {"progress", [](knurl_hand* h, Given&) { return knurl_progress(h); }},
    {"limits_of", [](knurl_hand* h, Given& g) { return knurl_limits_of(h, &g.limits); }},
    {"timing_of", [](knurl_hand* h, Given& g) { return knurl_timing_of(h, &g.timing); }},
    {"predicted_position", [](knurl_hand* h, Given& g) { return knurl_predicted_position(h, &g.vector); }},
    {"send_mesh", [](knurl_hand* h, Given& g) { return knurl_send_mesh(h, &g.mesh, &g.sent); }},
    {"send_heights", [](knurl_hand* h, Given& g) { return knurl_send_heights(h, &g.heights, &g.sent); }},
    {"begin_sending_mesh",
     [](knurl_hand* h, Given& g) { return knurl_begin_sending_mesh(h, &g.mesh, &g.sending); }},
    {"begin_sending_heights",
     [](knurl_hand* h, Given& g) { return knurl_begin_sending_heights(h, &g.heights, &g.sending); }},
    {"forget", [](knurl_hand* h, Given& g) { return knurl_forget(h, g.sent.asset); }},
    {"reset_fault",
     [](knurl_hand* h, Given&) {
         return knurl_reset_fault(h) == KNURL_REFUSED ? KNURL_OK : KNURL_BAD_HANDLE;
     }},
    {"connected", [](knurl_hand* h, Given& g) { return knurl_connected(h, &g.connected); }},
};
using OfAClient = std::pair<const char*, std::function<int(knurl_client*, Given&)>>;
const OfAClient of_a_client[] = {
    {"servo_pid", [](knurl_client* c, Given& g) { return knurl_servo_pid(c, &g.pid); }},
    {"device_at", [](knurl_client* c, Given& g) { return knurl_device_at(c, 0, &g.device); }},
    {"claim", [](knurl_client* c, Given& g) { return knurl_claim(c, nullptr, nullptr, &g.hand); }},
    {"observe", [](knurl_client* c, Given& g) { return knurl_observe(c, nullptr, &g.hand); }},
    {"reset_fault_of", [](knurl_client* c, Given&) { return knurl_reset_fault_of(c, nullptr); }},
    {"connected", [](knurl_client* c, Given& g) { return knurl_connected(c, &g.connected); }},
};

TEST_F(CHand, closed_null_foreign_and_made_up_handles_are_refused_by_every_call) {
    knurl_hand* closed = nullptr;
    ASSERT_TRUE(did(knurl_observe(client, nullptr, &closed)));
    ASSERT_TRUE(did(knurl_close(closed)));
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(closed), "closed"));
    knurl_client* closed_client = connect();
    ASSERT_TRUE(did(knurl_close(closed_client)));
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(closed_client)));
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_close(nullptr)));
    Given given, untouched;
    std::vector<void*> bad{
        nullptr, closed, closed_client, &given, reinterpret_cast<void*>(1), reinterpret_cast<void*>(~0ull)};
    for (int bit = 0; bit < 56; ++bit)  // the bits above are those of a fork
        bad.push_back(
            reinterpret_cast<void*>(reinterpret_cast<std::uint64_t>(hand) ^ std::uint64_t{1} << bit));
    for (void* handle : bad) {
        for (const Call& call : of_a_hand) {
            const int code = call.make(static_cast<knurl_hand*>(handle), given);
            EXPECT_TRUE(handle != client && (code == KNURL_BAD_HANDLE || code == 2 * KNURL_BAD_HANDLE))
                << call.name << " " << code;
            EXPECT_TRUE(one_line(knurl_error(handle))) << call.name;
        }
        for (const OfAClient& call : of_a_client)
            EXPECT_TRUE(fails(KNURL_BAD_HANDLE, call.second(static_cast<knurl_client*>(handle), given)))
                << call.first;
        EXPECT_TRUE(
            fails(KNURL_BAD_HANDLE, knurl_sending_done(static_cast<knurl_sending*>(handle), 0, &given.sent)));
        EXPECT_TRUE(
            fails(KNURL_BAD_HANDLE, knurl_sending_fd(static_cast<knurl_sending*>(handle), &given.fd)));
    }
    // A client where a hand is wanted, and the other way round.
    auto* const as_hand = reinterpret_cast<knurl_hand*>(client);
    auto* const as_client = reinterpret_cast<knurl_client*>(hand);
    for (const Call& call : of_a_hand) {
        if (std::string(call.name) == "connected") continue;
        EXPECT_NE(call.make(as_hand, given), KNURL_OK) << call.name;
        EXPECT_NE(std::string(knurl_error(as_hand)).find("this is a client"), std::string::npos)
            << knurl_error(as_hand);
    }
    for (const OfAClient& call : of_a_client)
        if (std::string(call.first) != "connected") {
            EXPECT_TRUE(fails(KNURL_BAD_HANDLE, call.second(as_client, given), "this is a hand"))
                << call.first;
        }
    EXPECT_EQ(given.number, 0u) << "nothing was filled in";
    EXPECT_EQ(std::memcmp(&given.report, &untouched.report, sizeof given.report), 0);
    // And with the right one each of them is done.
    for (const Call& call : of_a_hand) {
        int code = KNURL_NOTHING;
        ASSERT_TRUE(eventually([&] { return (code = call.make(hand, given)) != KNURL_NOTHING; }))
            << call.name;
        EXPECT_TRUE(did(code)) << call.name;
        if (given.sending != nullptr) {
            EXPECT_TRUE(did(knurl_close(std::exchange(given.sending, nullptr))));
        }
    }
}

TEST_F(CHand, null_pointers_are_refused_by_every_call) {
    const knurl_id id = add(KNURL_PLANE, plane(-1, 100));
    Given given;
    const std::pair<const char*, int> codes[] = {
        {"connected", knurl_connected(hand, nullptr)},
        {"servo_pid", knurl_servo_pid(client, nullptr)},
        {"device_at", knurl_device_at(client, 0, nullptr)},
        {"claim", knurl_claim(client, nullptr, nullptr, nullptr)},
        {"observe", knurl_observe(client, nullptr, nullptr)},
        {"newest", knurl_newest(hand, 0, nullptr)},
        {"latest", knurl_latest(hand, nullptr)},
        {"next_report", knurl_next_report(hand, 0, nullptr)},
        {"reports", knurl_reports(hand, nullptr, 5, &given.count)},
        {"reports without count", knurl_reports(hand, &given.report, 1, nullptr)},
        {"fd", knurl_fd(hand, nullptr)},
        {"missed", knurl_missed(hand, nullptr)},
        {"reattachments", knurl_reattachments(hand, nullptr)},
        {"device_of", knurl_device_of(hand, nullptr)},
        {"age", knurl_age(hand, 0, nullptr, nullptr)},
        {"network_of", knurl_network_of(hand, nullptr)},
        {"add", knurl_add(hand, KNURL_PLANE, nullptr, nullptr, &given.id)},
        {"add without out", knurl_add(hand, KNURL_PLANE, &given.floor, nullptr, nullptr)},
        {"set", knurl_set(hand, id, KNURL_PLANE, nullptr)},
        {"get", knurl_get(hand, id, KNURL_PLANE, nullptr)},
        {"feedback_of", knurl_feedback_of(hand, id, nullptr)},
        {"applied_stiffness", knurl_applied_stiffness(hand, id, nullptr)},
        {"limits_of", knurl_limits_of(hand, nullptr)},
        {"timing_of", knurl_timing_of(hand, nullptr)},
        {"predicted_position", knurl_predicted_position(hand, nullptr)},
        {"follow", knurl_follow(hand, id, nullptr, nullptr, 0, nullptr)},
        {"send_mesh", knurl_send_mesh(hand, nullptr, &given.sent)},
        {"send_mesh without out", knurl_send_mesh(hand, &given.mesh, nullptr)},
        {"send_heights", knurl_send_heights(hand, nullptr, &given.sent)},
        {"send_heights without out", knurl_send_heights(hand, &given.heights, nullptr)},
        {"begin_sending_mesh", knurl_begin_sending_mesh(hand, nullptr, &given.sending)},
        {"begin_sending_mesh without out", knurl_begin_sending_mesh(hand, &given.mesh, nullptr)},
        {"begin_sending_heights", knurl_begin_sending_heights(hand, nullptr, &given.sending)},
        {"begin_sending_heights without out", knurl_begin_sending_heights(hand, &given.heights, nullptr)},
    };
    for (const auto& [name, code] : codes) EXPECT_EQ(code, KNURL_BAD_ARGUMENT) << name;
    EXPECT_TRUE(did(knurl_begin_sending_heights(hand, &given.heights, &given.sending)));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_sending_fd(given.sending, nullptr)));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_sending_done(given.sending, 0, nullptr)));
    EXPECT_TRUE(did(knurl_commit(hand, nullptr)));
    EXPECT_TRUE(did(knurl_place_probe(hand, 0, nullptr, 0)));
}

/// A struct that a call fills in: wrong sizes, and a later version's.
template <class T, class Function>
void expect_room(const char* name, Function fill) {
    SCOPED_TRACE(name);
    for (const std::uint64_t size : wrong_sizes<T>()) {
        T out = sized<T>();
        out.size = size;
        EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, fill(&out), name)) << size;
    }
    Later<T> later;
    later.tail[0] = later.tail[2] = 7;
    ASSERT_TRUE(eventually([&] {
        const int code = fill(&later.known);
        EXPECT_GE(code, 0) << knurl_error(nullptr);
        return code != KNURL_NOTHING;
    }));
    EXPECT_EQ(later.known.size, sizeof later);
    EXPECT_EQ(later.tail[0] + later.tail[2], 14u) << "what the library does not know it leaves";
}

TEST_F(CHand, structs_of_other_sizes_are_refused_or_filled_in_as_far_as_known) {
    const knurl_id id = add(KNURL_PLANE, plane(-1, 100));
    Given given;
    expect_room<knurl_device>("knurl_device", [&](auto* out) { return knurl_device_at(client, 0, out); });
    expect_room<knurl_device>("knurl_device", [&](auto* out) { return knurl_device_of(hand, out); });
    expect_room<knurl_frame>("knurl_frame", [&](auto* out) { return knurl_newest(hand, 0, out); });
    expect_room<knurl_report>("knurl_report", [&](auto* out) { return knurl_latest(hand, out); });
    expect_room<knurl_report>("knurl_report", [&](auto* out) { return knurl_next_report(hand, 0, out); });
    expect_room<knurl_report>("knurl_report",
                              [&](auto* out) { return knurl_reports(hand, out, 1, &given.count); });
    expect_room<knurl_network>("knurl_network", [&](auto* out) { return knurl_network_of(hand, out); });
    expect_room<knurl_limits>("knurl_limits", [&](auto* out) { return knurl_limits_of(hand, out); });
    expect_room<knurl_timing>("knurl_timing", [&](auto* out) { return knurl_timing_of(hand, out); });
    expect_room<knurl_sent>("knurl_sent", [&](auto* out) { return knurl_send_mesh(hand, &given.mesh, out); });
    expect_room<knurl_sent>("knurl_sent",
                            [&](auto* out) { return knurl_send_heights(hand, &given.heights, out); });
    expect_room<knurl_followed>(
        "knurl_followed", [&](auto* out) { return knurl_follow(hand, id, flat_model, nullptr, 0, out); });
    expect_room<knurl_feedback>("knurl_feedback", [&](auto* out) {
        knurl_commit(hand, nullptr);
        return knurl_feedback_of(hand, id, out);
    });

    // What is read: a tail of zeros is a later version's default.
    knurl_claim_options claim_options;
    knurl_default_claim_options(&claim_options);
    knurl_add_options add_options;
    knurl_default_add_options(&add_options);
    const auto reads = [&]<class T>(const T& usual, auto give) {
        for (const std::uint64_t size : wrong_sizes<T>()) {
            T bad = usual;
            bad.size = size;
            EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, give(&bad))) << size;
        }
        Later<T> later(usual);
        EXPECT_NE(give(&later.known), KNURL_BAD_ARGUMENT) << knurl_error(nullptr);
        later.tail[1] = 1;
        EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, give(&later.known), "newer libknurl"));
    };
    reads(claim_options, [&](auto* options) { return knurl_claim(client, nullptr, options, &given.hand); });
    reads(add_options,
          [&](auto* options) { return knurl_add(hand, KNURL_PLANE, &given.floor, options, &given.id); });
    reads(given.floor,
          [&](auto* params) { return knurl_add(hand, KNURL_PLANE, params, nullptr, &given.id); });
    reads(given.floor, [&](auto* params) { return knurl_set(hand, id, KNURL_PLANE, params); });
    reads(given.mesh, [&](auto* mesh) { return knurl_send_mesh(hand, mesh, &given.sent); });
    reads(given.heights, [&](auto* heights) { return knurl_send_heights(hand, heights, &given.sent); });
    for (const std::uint64_t size : wrong_sizes<knurl_plane>()) {
        knurl_plane bad = plane(0, 0);
        bad.size = size;
        EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_get(hand, id, KNURL_PLANE, &bad))) << size;
    }
    EXPECT_TRUE(
        fails(KNURL_BAD_ARGUMENT, knurl_add(hand, 1'000'000, &given.floor, nullptr, &given.id), "1000000"));
    EXPECT_TRUE(fails(KNURL_STALE, knurl_set(hand, 0, KNURL_PLANE, &given.floor)));
    EXPECT_TRUE(fails(KNURL_STALE, knurl_remove(hand, ~knurl_id{0})));
}

TEST_F(CHand, is_closed_with_its_client_and_its_device_is_free) {
    Given given;
    knurl_hand* observer = nullptr;
    ASSERT_TRUE(did(knurl_observe(client, nullptr, &observer)));
    ASSERT_TRUE(did(knurl_begin_sending_mesh(hand, &given.mesh, &given.sending)));
    ASSERT_TRUE(did(knurl_close(client)));
    client = nullptr;
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_commit(hand, nullptr), "closed"));
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_latest(observer, &given.report), "closed"));
    EXPECT_TRUE(fails(KNURL_BAD_HANDLE, knurl_sending_fd(given.sending, &given.fd), "closed"));
    client = connect();
    EXPECT_TRUE(eventually([&] { return knurl_claim(client, nullptr, nullptr, &hand) == KNURL_OK; }));
}

/// A thread in a call that waits, known by its sleep.
class Waiting {
  public:
    explicit Waiting(std::function<int()> call)
        : thread_([this, call = std::move(call)] {
              id_ = static_cast<pid_t>(::syscall(SYS_gettid));
              code_ = call();
              line_ = knurl_error(nullptr);
              id_ = 0;
          }) {}
    ~Waiting() {
        if (thread_.joinable()) thread_.join();
    }
    /// It sleeps, or has ended already.
    bool waits() const {
        const pid_t id = id_;
        if (id < 0) return false;
        std::ifstream stat("/proc/self/task/" + std::to_string(id) + "/stat");
        std::string text;
        std::getline(stat, text);
        const std::size_t at = text.rfind(')');
        return id == 0 || (at != std::string::npos && text[at + 2] == 'S');
    }
    int code() {
        thread_.join();
        return code_;
    }
    const std::string& line() const { return line_; }

  private:
    std::atomic<pid_t> id_{-1};
    int code_ = 99;
    std::string line_;
    std::thread thread_;
};

TEST_F(CHand, a_call_that_waits_returns_when_another_thread_closes_it) {
    Given given;
    const std::pair<const char*, std::function<int(knurl_hand*)>> calls[] = {
        {"newest", [&](knurl_hand* h) { return knurl_newest(h, KNURL_FOREVER, &given.frame); }},
        {"next_report",
         [&](knurl_hand* h) {
             knurl_report report = sized<knurl_report>();
             for (;;)
                 if (const int code = knurl_next_report(h, KNURL_FOREVER, &report); code != KNURL_OK)
                     return code;
         }},
        {"wait_applied", [&](knurl_hand* h) { return knurl_wait_applied(h, 1'000'000, KNURL_FOREVER); }},
        {"send_mesh", [&](knurl_hand* h) { return knurl_send_mesh(h, &given.mesh, &given.sent); }},
        {"sending_done",
         [&](knurl_hand* h) {
             knurl_sending* sending = nullptr;
             if (const int code = knurl_begin_sending_mesh(h, &given.mesh, &sending)) return code;
             return knurl_sending_done(sending, KNURL_FOREVER, &given.sent);
         }},
    };
    for (const auto& [name, call] : calls) {
        for (const bool observes : {false, true}) {
            if (observes && std::string(name) != "newest" && std::string(name) != "next_report") continue;
            SCOPED_TRACE(std::string(name) + (observes ? " of an observer" : ""));
            knurl_hand* waited = hand;
            if (observes) {
                ASSERT_TRUE(did(knurl_observe(client, nullptr, &waited)));
            }
            servo->stop();  // nothing comes any more
            knurl_report report = sized<knurl_report>();
            while (knurl_next_report(waited, 50 * ms, &report) == KNURL_OK) {
            }
            Waiting thread([&] { return call(waited); });
            ASSERT_TRUE(eventually([&] { return thread.waits(); }));
            ASSERT_TRUE(did(knurl_close(waited)));
            EXPECT_EQ(thread.code(), KNURL_BAD_HANDLE) << thread.line();
            EXPECT_TRUE(one_line(thread.line().c_str()));
            servo->go_on();
            if (observes) continue;
            hand = nullptr;
            claim();
        }
    }
}

TEST_F(CHand, is_used_by_two_threads_at_once) {
    std::atomic<bool> end{false};
    std::atomic<int> read{0};
    std::thread reader([&] {
        knurl_report report = sized<knurl_report>();
        knurl_frame frame = sized<knurl_frame>();
        std::int64_t age = 0;
        while (!end) {
            EXPECT_GE(knurl_next_report(hand, 10 * ms, &report), 0);
            EXPECT_GE(knurl_newest(hand, 0, &frame), 0);
            EXPECT_GE(knurl_age(hand, report.read_ns, &age, nullptr), 0);
            ++read;
        }
    });
    // An instrumented servo may lack the time for what two threads add as fast as they can. The refusal, and what
    // follows from it (nothing is there that could be set or removed), comes out of whichever call is next.
    const auto taken = [](int code) {
        if (instrumented_servo && (code == KNURL_REFUSED || code == KNURL_STALE))
            return one_line(knurl_error(nullptr));
        return did(code);
    };
    std::atomic<int> whole{0};
    const auto change = [&] {
        for (int i = 0; i < 200; ++i) {
            knurl_id id = 0;
            const knurl_plane first = plane(-1, 100 + i), second = plane(-2, 100);
            int code = knurl_add(hand, KNURL_PLANE, &first, nullptr, &id);
            if (code == KNURL_CHANNEL_FULL || code == KNURL_REFUSED) continue;
            EXPECT_TRUE(did(code));
            const int set = knurl_set(hand, id, KNURL_PLANE, &second);
            EXPECT_TRUE(taken(set));
            EXPECT_TRUE(taken(knurl_commit(hand, nullptr)));
            EXPECT_TRUE(did(knurl_progress(hand)));
            code = knurl_remove(hand, id);
            EXPECT_TRUE(code == KNURL_CHANNEL_FULL || taken(code));
            whole += set == KNURL_OK && code == KNURL_OK ? 1 : 0;
        }
    };
    std::thread other(change);
    change();
    other.join();
    end = true;
    reader.join();
    EXPECT_GT(read, 0);
    EXPECT_GT(whole, 0);
    // What was refused last is told once; then the hand is as good as new.
    EXPECT_TRUE(taken(knurl_commit(hand, nullptr)));
    ASSERT_TRUE(eventually([&] {
        knurl_id id = 0;
        const knurl_plane last = plane(-1, 100);
        return knurl_add(hand, KNURL_PLANE, &last, nullptr, &id) == KNURL_OK &&
               knurl_commit(hand, nullptr) == KNURL_OK && knurl_wait_applied(hand, 0, 20 * s) == KNURL_OK &&
               knurl_remove(hand, id) == KNURL_OK;
    }));
}

TEST_F(CHand, is_closed_by_many_threads_once) {
    for (int i = 0; i < 50; ++i) {
        knurl_hand* observer = nullptr;
        ASSERT_TRUE(did(knurl_observe(client, nullptr, &observer)));
        std::atomic<int> closed{0};
        std::vector<std::thread> threads;
        for (int n = 0; n < 4; ++n)
            threads.emplace_back([&] {
                const int code = knurl_close(observer);
                EXPECT_TRUE(code == KNURL_OK || code == KNURL_BAD_HANDLE);
                closed += code == KNURL_OK ? 1 : 0;
            });
        for (std::thread& thread : threads) thread.join();
        ASSERT_EQ(closed, 1);
    }
}

TEST_F(CHand, that_comes_while_its_client_is_closed_is_closed_too) {
    for (int i = 0; i < 100; ++i) {
        knurl_client* const other = connect();
        knurl_hand* observer = nullptr;
        int code = 99;
        std::thread observing([&] { code = knurl_observe(other, nullptr, &observer); });
        EXPECT_TRUE(did(knurl_close(other)));
        observing.join();
        knurl_report report = sized<knurl_report>();
        if (code == KNURL_OK) {
            ASSERT_TRUE(fails(KNURL_BAD_HANDLE, knurl_latest(observer, &report))) << i;
        } else {
            ASSERT_LT(code, 0);
        }
    }
}

std::size_t descriptors() {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                                                  std::filesystem::directory_iterator{}));
}
/// Memory of this process (kB).
long resident() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
    return 0;
}

TEST(CLoop, thousands_of_connections_leave_nothing_behind) {
    // KNURL_TEST_SLOWLY: under valgrind, whose memory is not this process's alone either.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    constexpr bool instrumented = true;
#else
    const bool instrumented = std::getenv("KNURL_TEST_SLOWLY") != nullptr;
#endif
    const int all = instrumented ? 300 : ServoProcess::through_bridge() ? 2'000 : 10'000, settled = all / 5;
    const ServoProcess servo;
    long memory = 0;
    std::size_t open = 0;
    for (int i = 0; i < all; ++i) {
        knurl_client* const client = connect();
        knurl_hand* observer = nullptr;
        ASSERT_TRUE(did(knurl_observe(client, nullptr, &observer))) << i;
        if (i % 2 == 0) {
            ASSERT_TRUE(did(knurl_close(observer)));
        }
        ASSERT_TRUE(did(knurl_close(client)));
        if (i == settled) {
            memory = resident();
            open = descriptors();
        }
    }
    EXPECT_EQ(descriptors(), open);
    if (!instrumented) {
        EXPECT_LT(resident() - memory, 256)
            << "kB more than after " << settled << " of " << all << " connections";
    }
}

}  // namespace
}  // namespace capi_test
