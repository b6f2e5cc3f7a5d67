// What `knurl doctor` reads from the kernel's files. Each machine is a folder with such files.

#include <filesystem>
#include <fstream>

#include <doctor_machine.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace knurl::test {
namespace {

using cli::Finding;
using cli::Grade;
using testing::HasSubstr;

/// A root directory for the kernel's files.
class Root {
  public:
    Root& with(const std::string& path, const std::string& text) {
        const std::filesystem::path file = std::filesystem::path(folder_.path("")) / path;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << text;
        return *this;
    }
    std::filesystem::path path() const { return folder_.path(""); }
    Finding about(const std::string& what, unsigned cpu = 1) const {
        for (const Finding& finding : cli::look_at_settings(path(), cpu)) {
            if (finding.what == what) return finding;
        }
        ADD_FAILURE() << "nothing about " << what;
        return {};
    }

  private:
    Folder folder_;
};

TEST(DoctorSettings, WhatIsNotThereIsLeftOut) {
    for (const Finding& finding : cli::look_at_settings(Root().path(), 1))
        EXPECT_THAT((std::vector<std::string>{"idle states", "preemption"}), testing::Contains(finding.what))
            << finding.says;
}

TEST(DoctorSettings, ThrottlingIsToldWithItsHold) {
    Root root;
    root.with("proc/sys/kernel/sched_rt_period_us", "1000000\n")
        .with("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
    EXPECT_EQ(root.about("throttling").grade, Grade::note);
    EXPECT_THAT(root.about("throttling").says, HasSubstr("50 ms of every 1000 ms"));
    EXPECT_EQ(root.about("throttling").mend, "sudo sysctl kernel.sched_rt_runtime_us=-1");
    root.with("proc/sys/kernel/sched_rt_runtime_us", "-1\n");
    EXPECT_EQ(root.about("throttling").grade, Grade::good);
}

TEST(DoctorSettings, TheDeepestIdleStateThatIsAllowedIsNamed) {
    Root root;
    root.with("sys/devices/system/cpu/cpuidle/current_driver", "intel_idle\n");
    const std::string states = "sys/devices/system/cpu/cpu3/cpuidle/";
    root.with(states + "state0/name", "POLL\n").with(states + "state0/latency", "0\n");
    root.with(states + "state1/name", "C1E\n").with(states + "state1/latency", "10\n");
    root.with(states + "state2/name", "C6\n").with(states + "state2/latency", "170\n");
    EXPECT_THAT(root.about("idle states", 3).says, HasSubstr("as deep as C6 (170 us"));
    EXPECT_THAT(root.about("idle states", 3).mend, HasSubstr("--idle poll"));
    root.with(states + "state2/disable", "1\n");
    EXPECT_THAT(root.about("idle states", 3).says, HasSubstr("as deep as C1E (10 us"));
}

TEST(DoctorSettings, WhoHoldsTheLatencyDownIsNamed) {
    Root root;
    root.with("sys/devices/system/cpu/cpuidle/current_driver", "intel_idle\n");
    root.with("proc/4711/comm", "cyclictest\n").with("proc/4711/fd/0", "");
    std::filesystem::create_symlink("/dev/cpu_dma_latency", root.path() / "proc/4711/fd/7");
    EXPECT_EQ(root.about("idle states").grade, Grade::good);
    EXPECT_THAT(root.about("idle states").says, HasSubstr("4711 (cyclictest)"));
}

TEST(DoctorSettings, TheGovernorIsThatOfTheServosCpu) {
    Root root;
    root.with("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n");
    root.with("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave\n");
    EXPECT_EQ(root.about("governor", 0).grade, Grade::good);
    EXPECT_EQ(root.about("governor", 1).grade, Grade::note);
    EXPECT_THAT(root.about("governor", 1).mend, HasSubstr("cpupower"));
}

TEST(DoctorSettings, IsolatedCpusAreReadAsRanges) {
    Root root;
    root.with("sys/devices/system/cpu/isolated", "2-4,7\n");
    for (const unsigned cpu : {2u, 3u, 4u, 7u})
        EXPECT_EQ(root.about("isolation", cpu).grade, Grade::good) << cpu;
    for (const unsigned cpu : {0u, 1u, 5u, 6u})
        EXPECT_EQ(root.about("isolation", cpu).grade, Grade::note) << cpu;
    EXPECT_THAT(root.about("isolation", 5).mend, HasSubstr("isolcpus=5"));
}

TEST(DoctorSettings, ThePreemptionModelIsWhatTheKernelRunsWith) {
    struct Case {
        const char *version, *mode;
        Grade grade;
    };
    for (const Case& c :
         {Case{"Linux version 6.1.0-rt SMP PREEMPT_RT", nullptr, Grade::good},
          Case{"Linux version 6.1.0 SMP PREEMPT_DYNAMIC", "none voluntary (full)", Grade::good},
          Case{"Linux version 6.1.0 SMP PREEMPT_DYNAMIC", "none (voluntary) full", Grade::note},
          Case{"Linux version 6.1.0 SMP PREEMPT_DYNAMIC", nullptr, Grade::note},
          Case{"Linux version 5.10.0 SMP PREEMPT", nullptr, Grade::good},
          Case{"Linux version 5.10.0 SMP", nullptr, Grade::note}}) {
        Root root;
        root.with("proc/version", c.version);
        if (c.mode != nullptr) root.with("sys/kernel/debug/sched/preempt", c.mode);
        EXPECT_EQ(root.about("preemption").grade, c.grade)
            << c.version << " " << (c.mode != nullptr ? c.mode : "");
    }
}

TEST(DoctorSettings, AVirtualMachineIsToldApartFromHardware) {
    EXPECT_EQ(Root()
                  .with("proc/cpuinfo", "processor : 0\nflags : fpu sse2 hypervisor lahf_lm\n")
                  .about("hardware")
                  .grade,
              Grade::note);
    EXPECT_EQ(
        Root().with("proc/cpuinfo", "processor : 0\nflags : fpu sse2 lahf_lm\n").about("hardware").grade,
        Grade::good);
}

TEST(DoctorSettings, RightsAreReadFromWhatTheServoSaid) {
    const auto all = cli::look_at_rights("knurld 0.1.0: servo \"x\"\nknurld: ready\n");
    ASSERT_EQ(all.size(), 2u);
    for (const Finding& finding : all) EXPECT_EQ(finding.grade, Grade::good) << finding.what;
    const auto none = cli::look_at_rights(
        "knurld: memory is not locked (Cannot allocate memory; the limit is 8192 KiB): page faults will cost "
        "cycles; run: sudo "
        "setcap cap_sys_nice,cap_ipc_lock=ep /usr/bin/knurld\n"
        "knurld: no real-time priority (Operation not permitted) for knurl-servo 80: they will be late under "
        "load; run: sudo setcap "
        "cap_sys_nice,cap_ipc_lock=ep /usr/bin/knurld\nknurld: ready\n");
    ASSERT_EQ(none.size(), 2u);
    for (const Finding& finding : none) {
        EXPECT_EQ(finding.grade, Grade::bad) << finding.what;
        EXPECT_EQ(finding.mend, "sudo setcap cap_sys_nice,cap_ipc_lock=ep /usr/bin/knurld");
        EXPECT_THAT(finding.says, testing::Not(testing::EndsWith(";")));
    }
}

constexpr const char* two_cpus = "           CPU0       CPU1\n";

TEST(DoctorDisturbances, InterruptsOnTheServosCpuAreToldWithWhoAsks) {
    Root root;
    root.with("proc/stat", "cpu 1 2 3 4 5 6 7 100 0 0\n");
    root.with("proc/interrupts", std::string(two_cpus) +
                                     " 36:    5   1000 PCI-MSIX-0000:00:02.0   1-edge   virtio1-req.0\n"
                                     " 41:   10      7 PCI-MSIX-0000:00:04.0   1-edge   eth0-rx\n"
                                     "LOC:   50    900 Local timer interrupts\n");
    const auto before = cli::count_disturbances(root.path(), 1);
    root.with("proc/stat", "cpu 1 2 3 4 5 6 7 130 0 0\n");
    root.with("proc/interrupts", std::string(two_cpus) +
                                     " 36:    5   2500 PCI-MSIX-0000:00:02.0   1-edge   virtio1-req.0\n"
                                     " 41:  999      8 PCI-MSIX-0000:00:04.0   1-edge   eth0-rx\n"
                                     "LOC:   50   9000 Local timer interrupts\n");
    const auto after = cli::count_disturbances(root.path(), 1);
    const auto found = cli::look_at_disturbances(before, after, 10, 1);
    ASSERT_EQ(found.size(), 2u) << "the other CPU's, and the kernel's own timer, are no disturbance";
    EXPECT_THAT(found[0].says, HasSubstr("150 a second of virtio1-req.0 land on CPU 1"));
    EXPECT_EQ(found[0].mend, "echo 0 | sudo tee /proc/irq/36/smp_affinity_list");
    EXPECT_THAT(found[1].says, HasSubstr("3.0 %"));
}

TEST(DoctorDisturbances, AQuietMachineIsCalledQuiet) {
    Root root;
    root.with("proc/interrupts", std::string(two_cpus) + "LOC: 50 900 Local timer interrupts\n");
    const auto counts = cli::count_disturbances(root.path(), 1);
    const auto found = cli::look_at_disturbances(counts, counts, 10, 1);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].grade, Grade::good);
}

}  // namespace
}  // namespace knurl::test
