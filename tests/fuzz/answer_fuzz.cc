// A foreign server's answers, as the SDK takes them.
#include <cstdint>
#include <cstring>

#include "client/answer_check.h"

// Input: answers, each behind its length in two bytes. The length 0xFFFF has no answer: the stream broke, and another
// one goes on.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  latvox::client::VoxelizeHandlers handlers;
  handlers.on_bricks = [](const latvox::client::BrickBatch&) { return absl::OkStatus(); };
  latvox::client::AnswerCheck check(handlers, 1);
  while (size >= 2) {
    uint16_t length;
    std::memcpy(&length, data, 2);
    data += 2;
    size -= 2;
    if (length == 0xFFFF) {
      check.BeginStretch();
      continue;
    }
    if (length > size) length = static_cast<uint16_t>(size);
    latvox::v1::VoxelizeResponse answer;
    if (!answer.ParseFromArray(data, length) || !check.Take(answer).ok()) return 0;
    data += length;
    size -= length;
  }
  (void)check.End();
  return 0;
}
