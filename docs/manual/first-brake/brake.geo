// From the STEP file to a mesh with names.
//
//   gmsh -3 brake.geo -o brake.msh
SetFactory("OpenCASCADE");
parts() = ShapeFromFile("brake.step"); // in mm: [mesh] unit of the model file

// 1. Find the solids by place: each box {xmin, ymin, zmin, xmax, ymax, zmax} contains one of
// them as a whole. (Tools > Visibility in Gmsh lists numbers, which may be used instead.)
disc            = Volume In BoundingBox {-131, -131,  -7, 131, 131, 41};
lining_outer    = Volume In BoundingBox { -60,   70,   5,  60, 130, 17};
lining_inner    = Volume In BoundingBox { -60,   70, -17,  60, 130, -5};
backplate_outer = Volume In BoundingBox { -60,   70,  15,  60, 130, 22};
backplate_inner = Volume In BoundingBox { -60,   70, -22,  60, 130, -15};

// 2. Glue each lining to its backplate: they share the surface between them, and its nodes.
// Disc and linings remain separate, although they touch: they meet by contact.
BooleanFragments { Volume{lining_outer}; Delete; }{ Volume{backplate_outer}; Delete; }
BooleanFragments { Volume{lining_inner}; Delete; }{ Volume{backplate_inner}; Delete; }

// 3. One physical volume for each part.
Physical Volume("disc") = {disc};
Physical Volume("lining_outer") = {lining_outer};
Physical Volume("lining_inner") = {lining_inner};
Physical Volume("backplate_outer") = {backplate_outer};
Physical Volume("backplate_inner") = {backplate_inner};

// 4. One physical surface for each face that the model file names. The boxes of the disc's
// faces contain the pads' faces too, so these are taken out.
pad_face_outer() = Surface In BoundingBox {-60, 70,  5.9, 60, 130,  6.1};
pad_face_inner() = Surface In BoundingBox {-60, 70, -6.1, 60, 130, -5.9};
disc_face_outer() = Surface In BoundingBox {-131, -131,  5.9, 131, 131,  6.1};
disc_face_inner() = Surface In BoundingBox {-131, -131, -6.1, 131, 131, -5.9};
disc_face_outer() -= pad_face_outer();
disc_face_inner() -= pad_face_inner();
Physical Surface("pad_face_outer") = {pad_face_outer()};
Physical Surface("pad_face_inner") = {pad_face_inner()};
Physical Surface("disc_face_outer") = {disc_face_outer()};
Physical Surface("disc_face_inner") = {disc_face_inner()};
back_outer() = Surface In BoundingBox {-60, 70,  20.9, 60, 130,  21.1};
back_inner() = Surface In BoundingBox {-60, 70, -21.1, 60, 130, -20.9};
bore() = Surface In BoundingBox {-31, -31, 31, 31, 31, 41};
Physical Surface("back_outer") = {back_outer()};
Physical Surface("back_inner") = {back_inner()};
Physical Surface("bore") = {bore()};

// 5. Element sizes (mm): the pads are finer, since they have the contact points.
MeshSize { PointsOf{ Volume{disc}; } } = 12;
pads() = {lining_outer, lining_inner, backplate_outer, backplate_inner};
MeshSize { PointsOf{ Volume{pads()}; } } = 7;
Mesh.MeshSizeMax = 12;
Mesh.ElementOrder = 2;      // 10-node tetrahedra
Mesh.SecondOrderLinear = 0; // midside nodes on the curved CAD faces
Mesh.HighOrderOptimize = 2; // untangles elements that curved faces have inverted
Mesh.Optimize = 1;
Mesh.Binary = 1;
Mesh.MshFileVersion = 4.1;
