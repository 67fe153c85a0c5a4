// Decodes in this process, on a thread for each decode, without protection from hostile bytes.
#ifndef LATVOX_TESTS_UNIT_SERVER_THREAD_DECODER_H_
#define LATVOX_TESTS_UNIT_SERVER_THREAD_DECODER_H_

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/decode/draco_decoder.h"
#include "server/decode/mesh_decoder.h"

namespace latvox {

class ThreadDecoder : public MeshDecoder {
 public:
  ~ThreadDecoder() override {
    for (std::thread& thread : threads_) thread.join();
  }

  std::shared_ptr<Decoding> Start(EncodedMesh mesh, const Limits& limits, Reserve /*reserve*/, Done done) override {
    auto decoding = std::make_shared<Flag>();
    OnThread([decoding, bytes = std::string(mesh.bytes), limits, wanted = mesh.wanted, done = std::move(done)] {
      auto decoded = DecodeDraco(bytes, limits, wanted);
      done(decoding->cancelled ? absl::CancelledError("the decode was cancelled") : std::move(decoded));
    });
    return decoding;
  }

 protected:
  // Runs task(), and is not destroyed before its end.
  template <class F>
  void OnThread(F task) {
    const std::lock_guard lock(mu_);
    threads_.emplace_back(std::move(task));
  }

 private:
  struct Flag : Decoding {
    void Cancel() override { cancelled = true; }
    std::atomic<bool> cancelled = false;
  };

  std::mutex mu_;
  std::vector<std::thread> threads_;
};

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_THREAD_DECODER_H_
