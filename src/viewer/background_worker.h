#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace colmap_ext {

// Runs jobs one after the other on its own thread. The destructor waits for the
// current job and drops the others.
class BackgroundWorker {
 public:
  using Job = std::function<void()>;

  // \param on_error  called by the worker's thread with a job's exception.
  explicit BackgroundWorker(
      std::function<void(const std::exception& error)> on_error)
      : on_error_(std::move(on_error)), thread_([this] { Work(); }) {}
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

  void Add(Job job) {
    {
      const std::lock_guard lock(mutex_);
      jobs_.push_back({"", std::move(job)});
    }
    changed_.notify_all();
  }

  // Runs before all waiting jobs and replaces the urgent ones of its kind,
  // whose results are no longer needed.
  void AddUrgent(const std::string& kind, Job job) {
    {
      const std::lock_guard lock(mutex_);
      std::erase_if(jobs_,
                    [&](const auto& other) { return other.kind == kind; });
      jobs_.push_front({kind, std::move(job)});
    }
    changed_.notify_all();
  }

 private:
  struct Waiting {
    std::string kind;  // "" if it is not urgent
    Job job;
  };

  void Work() {
    while (true) {
      Job job;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return is_ended_ || !jobs_.empty(); });
        if (is_ended_) {
          return;
        }
        job = std::move(jobs_.front().job);
        jobs_.pop_front();
      }
      Do(job);
    }
  }

  // Exceptions of jobs do not end the thread.
  void Do(const Job& job) noexcept {
    try {
      try {
        job();
      } catch (const std::exception& error) {
        on_error_(error);
      }
    } catch (...) {  // out of memory for the message
    }
  }

  std::function<void(const std::exception& error)> on_error_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Waiting> jobs_;
  bool is_ended_ = false;
  std::thread thread_;  // last, because it uses the others
};

}  // namespace colmap_ext
