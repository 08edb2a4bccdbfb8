#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace colmap_ext {

// Does jobs one after the other on a thread of its own. When it is destroyed,
// the job at hand is finished and the others are dropped.
class BackgroundWorker {
 public:
  using Job = std::function<void()>;

  BackgroundWorker() : thread_([this] { Work(); }) {}
  ~BackgroundWorker() {
    {
      const std::lock_guard lock(mutex_);
      is_ended_ = true;
      jobs_.clear();
    }
    changed_.notify_all();
    thread_.join();
  }
  BackgroundWorker(const BackgroundWorker&) = delete;
  BackgroundWorker& operator=(const BackgroundWorker&) = delete;

  // \param job  must not throw.
  void Add(Job job) { Insert(std::move(job), false); }
  // Before all that wait.
  void AddFirst(Job job) { Insert(std::move(job), true); }

 private:
  void Insert(Job job, bool is_first) {
    {
      const std::lock_guard lock(mutex_);
      jobs_.insert(is_first ? jobs_.begin() : jobs_.end(), std::move(job));
    }
    changed_.notify_all();
  }

  void Work() {
    while (true) {
      Job job;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return is_ended_ || !jobs_.empty(); });
        if (is_ended_) {
          return;
        }
        job = std::move(jobs_.front());
        jobs_.pop_front();
      }
      job();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  bool is_ended_ = false;
  std::thread thread_;  // The last, as it uses the others.
};

}  // namespace colmap_ext
