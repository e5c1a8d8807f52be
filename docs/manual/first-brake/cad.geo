// Stands for your CAD program: a disc on its hat and two pads, as solids, written as a STEP file.
//
//   gmsh -parse_and_exit cad.geo
//
// Millimetres. The disc turns about z; inner = below (z < 0), outer = above.
SetFactory("OpenCASCADE");

// disc: rubbing ring, hat wall, hat top with the bore
Cylinder(1) = {0, 0, -6,  0, 0, 12, 130};
Cylinder(2) = {0, 0, -6,  0, 0, 46, 72};
ring() = BooleanUnion { Volume{1}; Delete; }{ Volume{2}; Delete; };
Cylinder(3) = {0, 0, -6,  0, 0, 38, 64};
Cylinder(4) = {0, 0, 20,  0, 0, 30, 30};
disc() = BooleanDifference { Volume{ring()}; Delete; }{ Volume{3}; Volume{4}; Delete; };

// Pads: sectors of 50 degrees, the lining 10 thick, the backplate 5 thick, in contact with the disc.
Macro Sector // from radius r0 to r1, height z to z + t
  outer = newv;  Cylinder(outer) = {0, 0, z,  0, 0, t, r1, 50*Pi/180};
  inner = newv;  Cylinder(inner) = {0, 0, z,  0, 0, t, r0};
  sector() = BooleanDifference { Volume{outer}; Delete; }{ Volume{inner}; Delete; };
  Rotate { {0, 0, 1}, {0, 0, 0}, 65*Pi/180 } { Volume{sector()}; }
Return
r0 = 82;  r1 = 126;
z = 6;    t = 10;  Call Sector;
z = -16;  t = 10;  Call Sector;
z = 16;   t = 5;   Call Sector;
z = -21;  t = 5;   Call Sector;

Save "brake.step";
