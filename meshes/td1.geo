// The brake of the Ansys Technology Showcase, problem TD-1: a ventilated disc on its hat, and two pads.
//
//   gmsh -3 meshes/td1.geo -setnumber size N -o td1.msh
//
// N = 1 coarse, 2 medium, 3 fine: the same geometry. Millimetres. The disc turns about z; the pads are at +y, 0.1 from the
// cheeks; inner = below (z < 0), outer = above. Dimensions as measured on the published surface mesh of the problem.
// Written for Gmsh >= 4.8, OpenCASCADE.

SetFactory("OpenCASCADE");
DefineConstant[ size = {2, Choices{1 = "coarse", 2 = "medium", 3 = "fine"}, Name "Size"} ];
If (size != 1 && size != 2 && size != 3)
  Error("size must be 1 (coarse), 2 (medium) or 3 (fine), not %g", size);
  Exit;
EndIf

// element edge, mm   coarse  medium  fine
h_disc_()    = {          30,     16,    9 };
h_pad_()     = {          15,      9,    6 };
per_turn_()  = {           6,      8,    8 };  // elements around a hole
h_disc = h_disc_(size - 1);  h_pad = h_pad_(size - 1);

// --------------------------------------------------------------------------------------------------------- dimensions
R = 175;  r = 125;  height = 35;  cheek = 10;    // cheeks: radii, height over both, thickness of one
vanes = 21;  vane = 13.1834*Pi/180;  first = 4.004*Pi/180;  // number, angle, centre of the first
flange_t = 10;
hat_R = 112.5;  hat_r = 105;  hat_z = 75;  top_t = 10;  bore_r = 40;
hole_n = 5;  hole_pcr = 75;  hole_r = 10;  hole_first = 18*Pi/180;
pad_R = 167.5;  pad_r = 130;  pad_t = 15;  pad_a0 = 60*Pi/180;  pad_a1 = 120*Pi/180;  gap = 0.1;

// ------------------------------------------------------------------------------------------------------------- solids
// A rectangle of the half plane at angle a0, r0 to r1 and z0 to z1, turned by the angle da. Out: vol.
Macro Sector
  p = newp;
  Point(p)     = {r0*Cos(a0), r0*Sin(a0), z0};  Point(p + 1) = {r1*Cos(a0), r1*Sin(a0), z0};
  Point(p + 2) = {r1*Cos(a0), r1*Sin(a0), z1};  Point(p + 3) = {r0*Cos(a0), r0*Sin(a0), z1};
  c = newl;
  Line(c) = {p, p + 1};  Line(c + 1) = {p + 1, p + 2};  Line(c + 2) = {p + 2, p + 3};  Line(c + 3) = {p + 3, p};
  ll = newll;  Curve Loop(ll) = {c, c + 1, c + 2, c + 3};
  surf = news;  Plane Surface(surf) = {ll};
  out() = Extrude { {0, 0, 1}, {0, 0, 0}, da } { Surface{surf}; };
  vol = out(1);
Return

// the disc's half section from the bore of the hat's top outwards, revolved
pu() = {bore_r,        hat_r,         hat_r, R, R,      r,      r,        hat_R,    hat_R, bore_r};
pv() = {hat_z - top_t, hat_z - top_t, 0,     0, height, height, flange_t, flange_t, hat_z, hat_z};
corners() = {};
For i In {0:#pu()-1}
  p = newp;  Point(p) = {pu(i), 0, pv(i)};  corners() += {p};
EndFor
sides() = {};
For i In {0:#corners()-1}
  c = newl;  Line(c) = {corners(i), corners((i + 1) % #corners())};  sides() += {c};
EndFor
ll = newll;  Curve Loop(ll) = {sides()};
surf = news;  Plane Surface(surf) = {ll};
out() = Extrude { {0, 0, 1}, {0, 0, 0}, 2*Pi } { Surface{surf}; };
disc = out(1);
Recursive Delete { Surface{surf}; }
// the channels between the vanes, open inwards and outwards
cuts() = {};
r0 = r - 5;  r1 = R + 5;  z0 = cheek;  z1 = height - cheek;  da = 2*Pi/vanes - vane;
For i In {0:vanes-1}
  a0 = first + vane/2 + 2*Pi*i/vanes;  Call Sector;
  cuts() += {vol};
EndFor
For i In {0:hole_n-1}
  a = hole_first + 2*Pi*i/hole_n;
  v = newv;  Cylinder(v) = {hole_pcr*Cos(a), hole_pcr*Sin(a), hat_z - 2*top_t, 0, 0, 3*top_t, hole_r};
  cuts() += {v};
EndFor
out() = BooleanDifference { Volume{disc}; Delete; }{ Volume{cuts()}; Delete; };
disc = out(0);

r0 = pad_r;  r1 = pad_R;  a0 = pad_a0;  da = pad_a1 - pad_a0;
z0 = -gap - pad_t;  z1 = -gap;  Call Sector;
pad_inner = vol;
z0 = height + gap;  z1 = height + gap + pad_t;  Call Sector;
pad_outer = vol;

// ---------------------------------------------------------------------------------------------------------------- names
Physical Volume("disc") = {disc};
Physical Volume("pad_inner") = {pad_inner};
Physical Volume("pad_outer") = {pad_outer};

// Faces of a part within a box. In: part, and the box (grown by tol). Out: found().
tol = 0.02;
Macro Faces
  near() = Surface In BoundingBox {bx0 - tol, by0 - tol, bz0 - tol, bx1 + tol, by1 + tol, bz1 + tol};
  own() = Abs(Boundary { Volume{part}; });
  found() = {};
  For i In {0:#near()-1}
    For j In {0:#own()-1}
      If (near(i) == own(j))
        found() += {near(i)};
      EndIf
    EndFor
  EndFor
  If (#found() == 0)
    Error("no face of part %g in the box (%g %g %g) (%g %g %g)", part, bx0, by0, bz0, bx1, by1, bz1);
  EndIf
Return

bx0 = -R;  bx1 = R;  by0 = -R;  by1 = R;
part = disc;  bz0 = 0;  bz1 = 0;  Call Faces;
Physical Surface("disc_inner_face") = found();
bz0 = height;  bz1 = height;  Call Faces;
Physical Surface("disc_outer_face") = found();
part = pad_inner;  bz0 = -gap;  bz1 = -gap;  Call Faces;
Physical Surface("pad_inner_face") = found();
bz0 = -gap - pad_t;  bz1 = -gap - pad_t;  Call Faces;
Physical Surface("pad_inner_back") = found();
part = pad_outer;  bz0 = height + gap;  bz1 = height + gap;  Call Faces;
Physical Surface("pad_outer_face") = found();
bz0 = height + gap + pad_t;  bz1 = height + gap + pad_t;  Call Faces;
Physical Surface("pad_outer_back") = found();
part = disc;  bz0 = hat_z - top_t;  bz1 = hat_z;
bx0 = -bore_r;  bx1 = bore_r;  by0 = -bore_r;  by1 = bore_r;  Call Faces;
hub() = found();
For h In {0:hole_n-1}
  a = hole_first + 2*Pi*h/hole_n;  x = hole_pcr*Cos(a);  y = hole_pcr*Sin(a);
  bx0 = x - hole_r;  bx1 = x + hole_r;  by0 = y - hole_r;  by1 = y + hole_r;  Call Faces;
  hub() += {found()};
EndFor
Physical Surface("hub") = hub();

// ---------------------------------------------------------------------------------------------------------------- mesh
MeshSize { PointsOf { Volume{disc}; } } = h_disc;
MeshSize { PointsOf { Volume{pad_inner, pad_outer}; } } = h_pad;
Mesh.MeshSizeExtendFromBoundary = 1;
Mesh.MeshSizeFromPoints = 1;
Mesh.MeshSizeFromCurvature = per_turn_(size - 1);
Mesh.Algorithm = 6;               // frontal-Delaunay
Mesh.Algorithm3D = 1;             // Delaunay
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 0;
Mesh.HighOrderOptimize = 1;
Mesh.Optimize = 3;                // passes
Mesh.OptimizeThreshold = 0.35;
General.NumThreads = 1;           // one thread and the default random seed: the same mesh every time
Mesh.MaxNumThreads1D = 1;  Mesh.MaxNumThreads2D = 1;  Mesh.MaxNumThreads3D = 1;
Mesh.MshFileVersion = 4.1;
Mesh.Binary = 1;
Mesh.SaveAll = 0;
