// Links: the ends of all lattice links that a mesh crosses.
#ifndef LATVOX_CORE_REQUEST_LINKS_H_
#define LATVOX_CORE_REQUEST_LINKS_H_

namespace latvox {

// The ends that belong to the set. VoxelizeOptions::interior_rule tells the inside.
enum class LinkSide { kBoth, kInside, kOutside };

struct Links {
  LinkSide side = LinkSide::kBoth;  // other than kBoth: the mesh must be closed by the rule
};

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_LINKS_H_
