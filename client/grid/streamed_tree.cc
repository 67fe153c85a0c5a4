#include "client/grid/streamed_tree.h"

#include <openvdb/io/Compression.h>

#include <memory>

namespace latvox::client {
namespace {

template <class T>
void Put(const T& value, std::ostream& out) {
  out.write(reinterpret_cast<const char*>(&value), sizeof(value));
}

openvdb::Coord UpperCorner(const TreePlace& place) { return openvdb::Coord(place.upper.data()); }

// A node's memory without its children, as OpenVDB counts it.
template <class Node>
openvdb::Index64 BytesOf() {
  return Node::NUM_VALUES * sizeof(typename Node::UnionType) + 2 * Node::NodeMaskType::memUsage() +
         sizeof(openvdb::Coord);
}

bool SameLower(const TreePlace& a, const TreePlace& b) { return a.upper == b.upper && a.lower == b.lower; }

// Returns the node of `leaf` and of the following bricks that belong to it; `leaf` becomes the first of the next node.
std::unique_ptr<Lower> MakeLower(BrickMerge& bricks, const Leaf*& leaf) {
  const TreePlace place = PlaceOf(leaf->origin());
  auto node = std::make_unique<Lower>(leaf->origin(), /*value=*/false, /*active=*/false);
  for (; leaf && SameLower(PlaceOf(leaf->origin()), place); leaf = bricks.Next()) node->addLeaf(new Leaf(*leaf));
  return node;
}

// Like InternalNode::writeTopology before the children: the mask of children, and no tiles.
void PutUpper(const Upper::NodeMaskType& children, std::ostream& out) {
  const Upper::NodeMaskType active;
  children.save(out);
  active.save(out);
  const auto values = std::make_unique<bool[]>(Upper::NUM_VALUES);
  openvdb::io::writeCompressedValues(out, values.get(), Upper::NUM_VALUES, active, children, /*toHalf=*/false);
}

[[noreturn]] void Stop() { OPENVDB_THROW(openvdb::IoError, "the bricks are not those of the survey"); }

}  // namespace

TreeSurvey Survey(BrickMerge& bricks) {
  TreeSurvey survey;
  bricks.Rewind();
  Upper::NodeMaskType* upper = nullptr;
  TreePlace last;
  while (const Leaf* leaf = bricks.Next()) {
    const TreePlace place = PlaceOf(leaf->origin());
    if (!upper || place.upper != last.upper) upper = &survey.uppers[UpperCorner(place)];
    if (!upper->isOn(place.lower)) ++survey.lowers;
    upper->setOn(place.lower);
    last = place;
    ++survey.leaves;
    survey.voxels += leaf->onVoxelCount();
    leaf->evalActiveBoundingBox(survey.box);
    survey.digest.Add(ToBrick(*leaf));
  }
  return survey;
}

// Like RootNode::writeTopology.
void StreamedTree::writeTopology(std::ostream& out, bool to_half) const {
  openvdb::TreeBase::writeTopology(out, to_half);
  Put(background(), out);
  openvdb::io::setGridBackgroundValuePtr(out, &background());
  Put(openvdb::Index{0}, out);  // tiles
  Put(static_cast<openvdb::Index>(survey_.uppers.size()), out);
  bricks_.Rewind();
  const Leaf* leaf = bricks_.Next();
  for (const auto& [corner, children] : survey_.uppers) {
    out.write(reinterpret_cast<const char*>(corner.asPointer()), 3 * sizeof(openvdb::Int32));
    PutUpper(children, out);
    for (auto child = children.beginOn(); child; ++child) {
      if (!leaf) Stop();
      const TreePlace place = PlaceOf(leaf->origin());
      if (UpperCorner(place) != corner || place.lower != child.pos()) Stop();
      MakeLower(bricks_, leaf)->writeTopology(out, to_half);
    }
  }
  if (leaf || !bricks_.status().ok()) Stop();
}

void StreamedTree::writeBuffers(std::ostream& out, bool to_half) const {
  bricks_.Rewind();
  uint64_t leaves = 0;
  for (; const Leaf* leaf = bricks_.Next(); ++leaves) leaf->writeBuffers(out, to_half);
  if (leaves != survey_.leaves) Stop();
}

bool StreamedTree::evalActiveVoxelBoundingBox(openvdb::CoordBBox& box) const {
  box = survey_.box;
  return survey_.voxels > 0;
}

// Like tools::memUsage.
openvdb::Index64 StreamedTree::memUsage() const {
  return sizeof(openvdb::BoolTree) + sizeof(RootNodeType) + survey_.uppers.size() * BytesOf<Upper>() +
         survey_.lowers * BytesOf<Lower>() + survey_.leaves * sizeof(Leaf);
}

}  // namespace latvox::client
