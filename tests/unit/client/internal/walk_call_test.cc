// Facts about the walks of labels, against servers with arbitrary answers.
#include <gmock/gmock.h>

#include <span>
#include <string>
#include <vector>

#include "tests/unit/client/fake_server.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

VoxelizeRequest Labeled() {
  VoxelizeRequest request;
  request.set = Enclosed{.labels = Field::kPart};
  request.fields = {Field::kPart};
  return request;
}

// Returns answers of an enclosed set of part 0, whose certificate has a walk for each of these counts of cavities.
Answers AnswersWith(const std::vector<uint64_t>& cavities) {
  Answers answers(kMesh.size());
  v1::Certificate& certificate = *answers.summary.mutable_summary()->mutable_certificate();
  certificate.set_set("enclosed");
  v1::WalkFacts& walk = *certificate.mutable_walk();
  for (const uint64_t count : cavities) {
    v1::LabelWalk& of_label = *walk.add_labels();
    of_label.set_label(static_cast<uint32_t>(walk.labels_size() - 1));
    of_label.set_cavities(count);
  }
  constexpr size_t kBytes = sizeof(uint32_t);
  const std::string parts(5 * kBytes, '\0');
  const auto of_voxels = [&parts](size_t voxels) { return std::as_bytes(std::span(parts)).first(voxels * kBytes); };
  answers.first.mutable_bricks()->add_fields()->set_values(parts.substr(0, kBytes));
  answers.second.mutable_bricks()->add_fields()->set_values(parts);
  Digest digest;
  digest.Add(Brick{{-1, 0, 0}, {1}}, of_voxels(1));
  digest.Add(Brick{{0, 0, 0}, {0xF0}}, of_voxels(4));
  digest.Add(Brick{{0, 7, 1}, {2}}, of_voxels(1));
  v1::FieldCertificate& field = *certificate.add_fields();
  field.set_field(v1::FIELD_PART);
  field.set_digest(digest.ToHex());
  return answers;
}

absl::StatusOr<Voxelization> Call(const VoxelizeRequest& request, const std::vector<uint64_t>& cavities) {
  return Fake(Send(AnswersWith(cavities).All())).client().VoxelizeAll(request, kMesh);
}

TEST(WalkCall, LabelsHaveWalksAndOtherSetsHaveNone) {
  EXPECT_TRUE(Call(Labeled(), {1, 2}).ok());
  EXPECT_THAT(std::string(Call(Labeled(), {}).status().message()), HasSubstr("without the walks of labels"));
  VoxelizeRequest plain = Labeled();
  plain.set = Enclosed{};
  EXPECT_TRUE(Call(plain, {}).ok());
  EXPECT_THAT(std::string(Call(plain, {1, 2}).status().message()), HasSubstr("with the walks of labels"));
}

TEST(WalkCall, TheWarningNamesEightLabelsThatEncloseNothingAndCountsTheOthers) {
  const auto messages = [](const std::vector<uint64_t>& cavities) {
    std::vector<std::string> found;
    const auto all = Call(Labeled(), cavities);
    EXPECT_TRUE(all.ok()) << all.status();
    for (const Warning& warning : all->summary.warnings) {
      if (warning.code == "LABEL_ENCLOSES_NOTHING")
        found.push_back(warning.message.substr(0, warning.message.find(':')));
    }
    return found;
  };
  EXPECT_THAT(messages({1, 2, 1}), IsEmpty());
  EXPECT_THAT(messages({0, 2, 0}), ElementsAre("part 0, 2"));
  EXPECT_THAT(messages({0, 0, 0, 0, 0, 0, 0, 0, 1}), ElementsAre("part 0, 1, 2, 3, 4, 5, 6, 7"));
  EXPECT_THAT(messages({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}), ElementsAre("part 0, 2, 3, 4, 5, 6, 7, 8 and 2 more"));
}

TEST(WalkCall, AnUnknownKindOfLeakIsNotReadAsNone) {
  const auto call = [](int kind, bool of_label) {
    Answers answers = AnswersWith({1});
    v1::WalkFacts& walk = *answers.summary.mutable_summary()->mutable_certificate()->mutable_walk();
    v1::Leak& leak = of_label ? *walk.mutable_labels(0)->mutable_leak() : *walk.mutable_leak();
    leak.set_kind(static_cast<v1::LeakKind>(kind));
    return Fake(Send(answers.All())).client().VoxelizeAll(Labeled(), kMesh);
  };
  for (const bool of_label : {false, true}) {
    EXPECT_TRUE(call(v1::LEAK_KIND_NONE, of_label).ok());
    for (const int kind : {0, 99}) {
      EXPECT_THAT(std::string(call(kind, of_label).status().message()), HasSubstr("a leak of an unknown kind"));
    }
  }
}

}  // namespace
}  // namespace latvox::client
