#include "rights.hpp"

#include <cstdint>
#include <fstream>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

namespace knurl::servo {

namespace {

namespace fs = std::filesystem;

std::string own_path() {
    char path[4096];
    const ssize_t n = readlink("/proc/self/exe", path, sizeof path);
    return n > 0 ? std::string(path, static_cast<std::size_t>(n)) : "knurld";
}

std::string grant_command() {
    return fmt::format("sudo setcap cap_sys_nice,cap_ipc_lock=ep {}", own_path());
}

/// Options for the container's engine, since nothing inside the container can grant the right.
constexpr const char* container_limits =
    "podman run --ulimit rtprio=95 --ulimit memlock=-1 ... (or docker run --cap-add SYS_NICE --cap-add "
    "IPC_LOCK ...)";

bool lists(const std::string& controllers, const std::string& one) {
    std::istringstream words(controllers);
    for (std::string word; std::getline(words, word, ',');)
        if (word == one) return true;
    return false;
}

}  // namespace

bool Rights::in_user_namespace() const {
    // The first user namespace maps all numbers to themselves.
    std::ifstream file(root_ / "proc/self/uid_map");
    std::uint64_t inside = 0, outside = 0, count = 0;
    if (!(file >> inside >> outside >> count)) return false;
    return inside != 0 || outside != 0 || count != 4294967295;
}

bool Rights::capable(int capability) const {
    if (in_user_namespace()) return false;
    std::ifstream status(root_ / "proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("CapEff:")) return (std::stoull(line.substr(7), nullptr, 16) >> capability) & 1;
    return false;
}

bool Rights::may_be_real_time(int priority) const {
    rlimit limit{};
    getrlimit(RLIMIT_RTPRIO, &limit);
    return capable(sys_nice) || limit.rlim_cur >= static_cast<rlim_t>(priority);
}

long Rights::number_in(const fs::path& file, long otherwise) const {
    std::ifstream in(file);
    long value = 0;
    return in >> value ? value : otherwise;
}

Rights::Group Rights::budget_group() const {
    Group v2;
    std::ifstream file(root_ / "proc/self/cgroup");
    for (std::string line; std::getline(file, line);) {  // "1:cpu,cpuacct:/user.slice", "0::/user.slice"
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1),
                          name = line.substr(second + 1);
        const fs::path below = fs::path(name).relative_path();
        if (lists(controllers, "cpu")) {
            for (const std::string& mount : {controllers, std::string("cpu")})
                if (const fs::path top = root_ / "sys/fs/cgroup" / mount;
                    fs::exists(top / "cpu.rt_runtime_us"))
                    return {.name = name, .folder = top / below, .top = top, .v1 = true};
        }
        if (!controllers.empty()) continue;
        // The nearest group with the controller enabled: groups below it share its budget.
        const fs::path top = root_ / "sys/fs/cgroup";
        fs::path at = below;
        while (!at.empty() && !fs::exists(top / at / "cpu.max")) at = at.parent_path();
        if (!at.empty()) v2 = {.name = fmt::format("/{}", at.string()), .folder = top / at, .top = top};
        if (at.empty() && fs::exists(top / "cpu.max"))
            v2 = {.name = std::string("/"), .folder = top, .top = top};
    }
    return v2;
}

std::string Rights::why_no_priority(int priority) const {
    if (!may_be_real_time(priority)) {
        if (in_user_namespace())
            return fmt::format(
                "they will be late under load; in this user namespace (a rootless container) no capability "
                "gives it, "
                "only a limit from outside; run: {}",
                container_limits);
        return "they will be late under load; run: " + grant_command();
    }
    // The right is there; what can still be missing is a real-time budget.
    if (number_in(root_ / "proc/sys/kernel/sched_rt_runtime_us", -1) == 0)
        return "the machine has no time for real-time threads (kernel.sched_rt_runtime_us is 0); run: "
               "sudo sysctl kernel.sched_rt_runtime_us=950000";
    const Group group = budget_group();
    const std::string mine = fmt::format("cgroup {} of this process", group.name);
    const fs::path budget = group.folder / "cpu.rt_runtime_us";
    if (group.name.empty() || (group.v1 && number_in(budget, 0) != 0))
        return "a sandbox refuses it (seccomp of a container, a security module); run: docker run --cap-add "
               "SYS_NICE "
               "--security-opt seccomp=unconfined ...";
    // Its group is not visible from inside, or it appears as the root.
    if (group.name == "/" || group.name.starts_with("/..") || (group.v1 && !fs::exists(budget)))
        return fmt::format(
            "the {} is a container's, which has no real-time budget; its engine gives one where cgroups are "
            "v1; run: "
            "docker run --cpu-rt-runtime=950000 --ulimit rtprio=95 ...",
            mine);
    const std::string root_group = (group.top / (group.v1 ? "tasks" : "cgroup.procs")).string();
    if (!group.v1)
        return fmt::format(
            "the {} has the cpu controller on, and with it no real-time budget (cgroup v2, a kernel with "
            "RT_GROUP_SCHED); move this shell to the root group and start again, or boot with "
            "rt_group_sched=0; run: "
            "echo $$ | sudo tee {}",
            mine, root_group);
    return fmt::format(
        "the {} has no real-time budget ({} is 0); move this shell to the root group and start again; run: "
        "echo $$ | "
        "sudo tee {}",
        mine, budget.string(), root_group);
}

std::string Rights::memory_command() const {
    return in_user_namespace() ? container_limits : grant_command();
}

}  // namespace knurl::servo
