#include "client/grid/openvdb_trees.h"

template class openvdb::tree::Tree<openvdb::BoolTree::RootNodeType>;
template class openvdb::Grid<openvdb::BoolTree>;
template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
template class openvdb::Grid<openvdb::FloatTree>;
template class openvdb::tree::Tree<openvdb::Int32Tree::RootNodeType>;
template class openvdb::Grid<openvdb::Int32Tree>;
template class openvdb::tree::Tree<openvdb::Vec3STree::RootNodeType>;
template class openvdb::Grid<openvdb::Vec3STree>;
