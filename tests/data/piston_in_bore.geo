// A piston of radius 27 in the bore of a block, both 40 high; the two surfaces coincide and share no nodes. Source of piston_in_bore.msh:
//   gmsh -3 piston_in_bore.geo
SetFactory("OpenCASCADE");
Cylinder(1) = {3.3, 1.7, 0, 0, 0, 40, 27};
Box(2) = {-40, -40, 0, 80, 80, 40};
Cylinder(3) = {3.3, 1.7, 0, 0, 0, 40, 27};
BooleanDifference(4) = { Volume{2}; Delete; }{ Volume{3}; Delete; };
Mesh.ElementOrder = 2;
Mesh.MeshSizeMin = 20;
Mesh.MeshSizeMax = 20;
Physical Volume("piston") = {1};
Physical Volume("block") = {4};
Physical Surface("piston_side") = {1};
Physical Surface("bore") = {10};
Physical Surface("outer") = {4};
