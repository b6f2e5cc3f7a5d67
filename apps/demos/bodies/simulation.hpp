#pragma once
// The simulation in its own thread: however long it takes, the coupling continues.

#include <condition_variable>
#include <mutex>
#include <thread>

#include "coupled.hpp"

namespace bodies {

class Simulation {
  public:
    /// `slow`: s added to each step, to try a slow simulation.
    Simulation(World& world, double slow) : world_(world), slow_(slow), thread_([this] { run(); }) {}
    ~Simulation() {
        {
            const std::lock_guard lock(mutex_);
            end_ = true;
        }
        wake_.notify_all();
        thread_.join();
    }
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    /// Starts one step. Until done() the thread owns the world.
    void begin(double dt, Orders orders) {
        {
            const std::lock_guard lock(mutex_);
            dt_ = dt;
            orders_ = std::move(orders);
            busy_ = true;
        }
        wake_.notify_all();
    }
    bool done() {
        const std::lock_guard lock(mutex_);
        return !busy_;
    }

  private:
    void run() {
        std::unique_lock lock(mutex_);
        while (!end_) {
            wake_.wait(lock, [this] { return busy_ || end_; });
            if (end_) return;
            lock.unlock();
            world_.step(dt_, orders_.pushes, orders_.pulls);
            if (slow_ > 0) std::this_thread::sleep_for(std::chrono::duration<double>(slow_));
            lock.lock();
            busy_ = false;
        }
    }

    World& world_;
    double slow_, dt_ = 0;
    Orders orders_;
    bool busy_ = false, end_ = false;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::thread thread_;
};

}  // namespace bodies
