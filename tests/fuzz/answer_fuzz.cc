// A foreign server's answers, as the SDK receives them: for a surface, for a band with its distances, for a solid with
// other fields, for links, and for enclosed sets.
#include <cstdint>
#include <cstring>

#include "client/internal/answer_check.h"

namespace {

// Input: answers, each after its length in two bytes. The length 0xFFFF has no answer: the stream broke, and a new one
// continues.
void Receive(const uint8_t* data, size_t size, const latvox::client::VoxelizeRequest& request) {
  latvox::client::VoxelizeHandlers handlers;
  handlers.on_bricks = [](const latvox::client::BrickBatch&) { return absl::OkStatus(); };
  latvox::client::AnswerCheck check(handlers, 1, request);
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
    if (!answer.ParseFromArray(data, length) || !check.Receive(answer).ok()) return;
    data += length;
    size -= length;
  }
  (void)check.End();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using latvox::client::Field;
  latvox::client::VoxelizeRequest request;
  Receive(data, size, request);
  request.set = latvox::client::Band{.width = 1};
  request.fields = {Field::kDistance};
  request.signed_distance = true;
  Receive(data, size, request);
  request.set = latvox::client::Solid{};
  request.fields = {Field::kColor, Field::kPart, Field::kTriangle, Field::kPoint, Field::kNormal};
  request.signed_distance = false;
  Receive(data, size, request);
  request.fields = {Field::kFraction};
  request.fraction_n = 2;
  Receive(data, size, request);
  request.fields = {Field::kLabelFractions};
  Receive(data, size, request);
  request.fraction_labels = {1, 0};
  Receive(data, size, request);
  request = {};
  request.set = latvox::client::Links{};
  request.fields = {Field::kLinks, Field::kLinkTriangles, Field::kLinkCrossings};
  Receive(data, size, request);
  request.set = latvox::client::Enclosed{.leak_from = latvox::client::Vec3d{1, 1, 1}};
  request.fields = {};
  Receive(data, size, request);
  request.set = latvox::client::Enclosed{.labels = Field::kPart};
  request.fields = {Field::kPart};
  Receive(data, size, request);
  return 0;
}
