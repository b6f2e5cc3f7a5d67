// Why a priority was refused, from the kernel's files: each reason has its own remedy.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "../temp_folder.hpp"
#include "rights.hpp"

namespace knurl::servo {
namespace {

namespace fs = std::filesystem;

/// A kernel's files, in a folder that is removed at the end. The process in it is root, with all
/// capabilities.
class Kernel {
  public:
    Kernel() {
        rlimit limit{};  // that of this process counts too
        ::getrlimit(RLIMIT_RTPRIO, &limit);
        limit.rlim_cur = 0;
        ::setrlimit(RLIMIT_RTPRIO, &limit);
        with("proc/self/uid_map", "         0          0 4294967295\n");
        with("proc/self/status", "Name:\ttest\nCapEff:\t000001ffffffffff\n");
        with("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
    }

    Kernel& with(const std::string& file, const std::string& text) {
        fs::create_directories((folder_ / file).parent_path());
        folder_.file(file, text);
        return *this;
    }
    std::string why() const { return Rights(folder_.path().string()).why_no_priority(80); }
    std::string path(const std::string& file) const { return folder_.path(file); }

  private:
    test::TempFolder folder_;
};

bool says(const std::string& text, const std::string& what) {
    return text.find(what) != std::string::npos;
}

TEST(RightsOf, AnOrdinaryUserNeedsTheCapability) {
    Kernel kernel;
    kernel.with("proc/self/status", "CapEff:\t0000000000000000\n");
    EXPECT_TRUE(says(kernel.why(), "run: sudo setcap cap_sys_nice,cap_ipc_lock=ep ")) << kernel.why();
}

TEST(RightsOf, InAUserNamespaceACapabilityGivesNothing) {
    Kernel kernel;
    kernel.with("proc/self/uid_map", "         0       1000          1\n");
    EXPECT_FALSE(Rights(kernel.path("")).capable(Rights::sys_nice)) << "though CapEff has it";
    EXPECT_TRUE(says(kernel.why(), "user namespace")) << kernel.why();
    EXPECT_TRUE(says(kernel.why(), "--ulimit rtprio=95")) << kernel.why();
    EXPECT_FALSE(says(kernel.why(), "setcap")) << kernel.why();
    EXPECT_FALSE(says(Rights(kernel.path("")).memory_command(), "setcap"));
}

TEST(RightsOf, AMachineWithoutTimeForRealTimeThreads) {
    Kernel kernel;
    kernel.with("proc/sys/kernel/sched_rt_runtime_us", "0\n");
    EXPECT_TRUE(says(kernel.why(), "run: sudo sysctl kernel.sched_rt_runtime_us=950000")) << kernel.why();
}

TEST(RightsOf, AGroupOfTheFirstKindWithoutABudgetIsNamedWithTheCommand) {
    Kernel kernel;
    kernel.with("proc/self/cgroup", "4:memory:/m\n3:cpu,cpuacct:/user.slice/mine\n0::/user.slice\n")
        .with("sys/fs/cgroup/cpu,cpuacct/cpu.rt_runtime_us", "950000\n")
        .with("sys/fs/cgroup/cpu,cpuacct/user.slice/mine/cpu.rt_runtime_us", "0\n");
    EXPECT_TRUE(says(kernel.why(), "cgroup /user.slice/mine of this process has no real-time budget"))
        << kernel.why();
    EXPECT_TRUE(says(kernel.why(), "user.slice/mine/cpu.rt_runtime_us is 0")) << kernel.why();
    EXPECT_TRUE(
        says(kernel.why(), "run: echo $$ | sudo tee " + kernel.path("sys/fs/cgroup/cpu,cpuacct/tasks")))
        << kernel.why();
    EXPECT_FALSE(says(kernel.why(), "sysctl")) << "which is set: " << kernel.why();
}

TEST(RightsOf, AGroupOfTheSecondKindIsTheNearestForWhichTheControllerIsOn) {
    Kernel kernel;
    kernel.with("proc/self/cgroup", "0::/user.slice/session.scope/deep\n")
        .with("sys/fs/cgroup/user.slice/cpu.max", "max 100000\n")
        .with("sys/fs/cgroup/user.slice/session.scope/deep/cgroup.procs", "");
    EXPECT_TRUE(says(kernel.why(), "cgroup /user.slice of this process")) << kernel.why();
    EXPECT_TRUE(says(kernel.why(), "run: echo $$ | sudo tee " + kernel.path("sys/fs/cgroup/cgroup.procs")))
        << kernel.why();
}

TEST(RightsOf, AContainersOwnGroupGetsItsBudgetFromOutside) {
    Kernel kernel;
    kernel.with("proc/self/cgroup", "1:cpu:/\n0::/\n").with("sys/fs/cgroup/cpu/cpu.rt_runtime_us", "0\n");
    EXPECT_TRUE(says(kernel.why(), "docker run --cpu-rt-runtime")) << kernel.why();
    kernel.with("proc/self/cgroup",
                "1:cpu:/docker/0123\n");  // seen with the host's name, mounted as the root
    EXPECT_TRUE(says(kernel.why(), "docker run --cpu-rt-runtime")) << kernel.why();
}

TEST(RightsOf, WhatHasARightAndABudgetIsRefusedBySomethingElse) {
    Kernel kernel;
    kernel.with("proc/self/cgroup", "1:cpu:/\n0::/\n")
        .with("sys/fs/cgroup/cpu/cpu.rt_runtime_us", "950000\n");
    EXPECT_TRUE(says(kernel.why(), "seccomp")) << kernel.why();
}

}  // namespace
}  // namespace knurl::servo
