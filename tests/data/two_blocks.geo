// Two blocks that share the face z = 1 (a conformal interface), 1 x 1 x 1 and 1 x 1 x 0.5. Source of two_blocks_*.msh:
//   gmsh -3 two_blocks.geo -o two_blocks_ascii.msh
//   gmsh -3 two_blocks.geo -bin -o two_blocks_binary.msh
//   gmsh -3 two_blocks.geo -setnumber Mesh.SaveParametric 1 -o two_blocks_parametric.msh
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Box(2) = {0, 0, 1, 1, 1, 0.5};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Mesh.ElementOrder = 2;
Mesh.MeshSizeMin = 0.5;
Mesh.MeshSizeMax = 0.5;
e = 1e-3;
Physical Volume("lower") = {1};
Physical Volume("upper block") = {2};
Physical Surface("bottom") = Surface In BoundingBox{-e, -e, -e, 1+e, 1+e, e};
Physical Surface("top") = Surface In BoundingBox{-e, -e, 1.5-e, 1+e, 1+e, 1.5+e};
Physical Surface("interface") = Surface In BoundingBox{-e, -e, 1-e, 1+e, 1+e, 1+e};
Physical Curve("edge") = Curve In BoundingBox{-e, -e, -e, 1+e, e, e};
Physical Point("corner") = Point In BoundingBox{-e, -e, -e, e, e, e};
