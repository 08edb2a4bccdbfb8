#include "viewer/background_worker.h"

#include <future>
#include <new>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace colmap_ext::background_worker_test {

class BackgroundWorkerTest : public testing::Test {
 protected:
  // Returns when all jobs are done.
  void Finish() {
    std::promise<void> done;
    worker_.Add([&] { done.set_value(); });
    done.get_future().wait();
  }

  std::string log_;  // changed by the worker's thread alone
  BackgroundWorker worker_{[this](const std::exception& error) {
    log_ += error.what();
    if (log_ == "last straw") {
      throw std::bad_alloc();
    }
  }};
};

TEST_F(BackgroundWorkerTest, SaysWhatJobsThrowAndGoesOn) {
  worker_.Add([] { throw std::runtime_error("no image"); });
  worker_.Add([this] { log_ += ", a mesh"; });
  Finish();
  EXPECT_EQ(log_, "no image, a mesh");
}

TEST_F(BackgroundWorkerTest, GoesOnWhereItCanNotEvenSayWhatIsWrong) {
  worker_.Add([] { throw std::runtime_error("last straw"); });
  worker_.Add([] { throw 7; });
  worker_.Add([this] { log_ += ", done"; });
  Finish();
  EXPECT_EQ(log_, "last straw, done");
}

TEST_F(BackgroundWorkerTest, OfUrgentJobsOfAKindThatWaitTheLastIsDone) {
  std::promise<void> start;
  std::promise<void> gate;
  worker_.Add([&] {
    start.set_value();
    gate.get_future().wait();
  });
  start.get_future().wait();
  worker_.Add([this] { log_ += " last"; });
  for (const char* name : {" a1", " a2", " a3"}) {
    worker_.AddUrgent("a", [this, name] { log_ += name; });
  }
  worker_.AddUrgent("b", [this] { log_ += " b"; });
  gate.set_value();
  Finish();
  EXPECT_EQ(log_, " b a3 last");
}

}  // namespace colmap_ext::background_worker_test
