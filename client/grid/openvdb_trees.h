// OpenVDB, and the trees that latvox::grid reads and writes. Only openvdb_trees.cc compiles them: another file with a
// grid would compile all functions of its type, for ten seconds each. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_OPENVDB_TREES_H_
#define LATVOX_CLIENT_GRID_OPENVDB_TREES_H_

#include <openvdb/openvdb.h>

extern template class openvdb::tree::Tree<openvdb::BoolTree::RootNodeType>;
extern template class openvdb::Grid<openvdb::BoolTree>;
extern template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
extern template class openvdb::Grid<openvdb::FloatTree>;
extern template class openvdb::tree::Tree<openvdb::Int32Tree::RootNodeType>;
extern template class openvdb::Grid<openvdb::Int32Tree>;
extern template class openvdb::tree::Tree<openvdb::Vec3STree::RootNodeType>;
extern template class openvdb::Grid<openvdb::Vec3STree>;

#endif  // LATVOX_CLIENT_GRID_OPENVDB_TREES_H_
