// Demo brake of squeal: ventilated disc, two pads, piston, floating caliper, bracket.
//
//   gmsh -3 meshes/brake.geo -setnumber size N -o brake.msh
//
// N = 1 small, 2 medium, 3 full, 4 million. `-setnumber extruded_disc 1`: the disc without fillets, extruded layer by layer
// from a plan, in hexahedra and some wedges of second order; 2: the same disc in tetrahedra. Millimetres. The disc turns about z, its mid-plane is z = 0; the pads are
// at +y; left/right = -x/+x; inner = z < 0 (piston), outer = z > 0 (fingers). Written for Gmsh >= 4.8, OpenCASCADE.
// meshes/README.md has the dimensions, the names and the node counts.

SetFactory("OpenCASCADE");
DefineConstant[ size = {3, Choices{1 = "small", 2 = "medium", 3 = "full", 4 = "million"}, Name "Size"} ];
If (size != 1 && size != 2 && size != 3 && size != 4)
  Error("size must be 1 (small), 2 (medium), 3 (full) or 4 (million), not %g", size);
  Exit;
EndIf
DefineConstant[ extruded_disc = {0, Choices{0 = "revolved", 1 = "hexahedra", 2 = "tetrahedra"}, Name "Extruded disc"} ];
hexahedra = (extruded_disc == 1);

// ---------------------------------------------------------------------------------------------- what the size decides
k = size - 1;
// element edge, mm    small  medium    full  million
h_disc_()     = {     34,   13.8,    5.7,   4.25 };
h_lining_()   = {     13,      7,    3.8,    3.0 };
h_plate_()    = {     15,    8.2,    4.3,    3.4 };
h_piston_()   = {     14,      9,      5,    3.8 };
h_caliper_()  = {     25,     13,    4.5,   3.75 };
h_bracket_()  = {     30,   13.5,    4.8,   3.95 };
per_turn_()   = {      6,      8,      7,      9 };  // elements around a full circle of a fillet, at least
per_hole_()   = {      8,      8,     12,     16 };  // elements around a hole
wall_h_()     = {     20,      7,    4.5,    3.5 };  // and along it
vanes_()      = {      7,     17,     17,     17 };  // primes: no doublet of a low nodal diameter is split
vane_n_()     = {      1,      1,      1,      2 };  // elements over a vane's height
rmin_()       = {    100,    8.5,      0,      0 };  // corner radii below this stay sharp
vane_n = vane_n_(k);  h_disc = h_disc_(k);  h_lining = h_lining_(k);  h_plate = h_plate_(k);  h_piston = h_piston_(k);
h_caliper = h_caliper_(k);  h_bracket = h_bracket_(k);  vanes = vanes_(k);  rmin = rmin_(k);

// --------------------------------------------------------------------------------------------------------- dimensions
// disc
disc_R = 140;  disc_t = 24;  cheek_t = 8;        // radius, thickness over both cheeks, one cheek
rub_r = 90;                                      // inner radius of the rubbing faces
cheek_r = 86;                                    // bore of the inner cheek
vane_r0 = (size == 1) ? cheek_r - 6 : 92;  vane_r1 = (size == 1) ? disc_R + 20 : 135;  vane_t = 200 / vanes;  // small: flush
hat_R = 78;  hat_t = 7;  hat_z = 46;             // hat: outer radius, wall, height of its top
bore_R = 32;  hub_n = 5;  hub_pcd = 108;  hub_d = 14.5;
// pads
lin_t = 11;  lin_R = 136;  lin_r = 94;           // lining: thickness, outer and inner radius
lin_x0 = 46;  lin_x1 = 54;                       // half widths at the inner and outer corner
cham_w = 8;  cham_d = 3.5;                       // chamfers at the leading and trailing edge
slot_w = 4;  slot_d = 7;                         // radial slot
bp_t = 5.5;  bp_R = 139.5;  bp_r = 90.5;  bp_x0 = 49;  bp_x1 = 57;
ear_x0 = 60.5;  ear_x1 = 70;  ear_y0 = 98;  ear_y1 = 112;   // the part of an ear that sits in the bracket
// piston and caliper
pis_y = 115;  pis_R = 22;  pis_r = 14.5;  pis_l = 42;  pis_floor = 7;
cyl_R = 32;  cyl_z0 = -92;  cyl_z1 = -39;  bore_z = -80;    // housing, and the floor of its bore
bri_r = 144;                                     // the caliper's bridge keeps outside this radius
fin_t = 16;                                      // fingers
lug_z0 = -64;  lug_z1 = -52;                     // guide pin lugs
pin_x = 80;  pin_y = 133;  pin_R = 6;
// bracket
brk_z = 36;  brk_gap = 15;  brk_r = 143.5;       // abutments from |z| = brk_gap to brk_z; radius over the disc's rim
boss_z = -48;  pinhole_z = -10;                  // inboard end of the pin bosses, bottom of the pin holes
bolt_x = 68;  bolt_y = 46;  bolt_R = 6.5;

z_rub = disc_t / 2;  z_lin = z_rub + lin_t;  z_back = z_lin + bp_t;   // 12, 23, 28.5
eps = 1e-3;

// ------------------------------------------------------------------------------------------------------------- helpers
// Prism over a polygon with rounded corners. In: pu(), pv(), pr() (corner radii), plane (0: u,v = x,y; 1: y,z; 2: x,z),
// w0 and w1 (extent across the plane; w0 == w1 gives only the surface). Out: surf, vol.
Macro RoundPoly
  n = #pu();  first() = {};  last() = {};  crv() = {};
  For i In {0:n-1}
    a = (i + n - 1) % n;  b = (i + 1) % n;
    ux = pu(a) - pu(i);  uy = pv(a) - pv(i);  l = Sqrt(ux*ux + uy*uy);  ux = ux / l;  uy = uy / l;
    vx = pu(b) - pu(i);  vy = pv(b) - pv(i);  l = Sqrt(vx*vx + vy*vy);  vx = vx / l;  vy = vy / l;
    np = 1;  qu() = {pu(i)};  qv() = {pv(i)};
    If (pr(i) > 0 && pr(i) >= rmin)
      half = Acos(ux*vx + uy*vy) / 2;
      l = Sqrt((ux + vx)^2 + (uy + vy)^2);
      np = 3;
      qu() = {pu(i) + ux*pr(i)/Tan(half), pu(i) + (ux + vx)/l*pr(i)/Sin(half), pu(i) + vx*pr(i)/Tan(half)};
      qv() = {pv(i) + uy*pr(i)/Tan(half), pv(i) + (uy + vy)/l*pr(i)/Sin(half), pv(i) + vy*pr(i)/Tan(half)};
    EndIf
    tag() = {};
    For j In {0:np-1}
      p = newp;
      If (plane == 0)
        Point(p) = {qu(j), qv(j), w0};
      ElseIf (plane == 1)
        Point(p) = {w0, qu(j), qv(j)};
      Else
        Point(p) = {qu(j), w0, qv(j)};
      EndIf
      tag() += {p};
    EndFor
    first() += {tag(0)};  last() += {tag(np-1)};
    If (np == 3)
      c = newl;  Circle(c) = {tag(0), tag(1), tag(2)};  crv() += {c};
    Else
      crv() += {-1};
    EndIf
  EndFor
  loop() = {};
  For i In {0:n-1}
    b = (i + 1) % n;
    If (crv(i) > 0)
      loop() += {crv(i)};
    EndIf
    c = newl;  Line(c) = {last(i), first(b)};  loop() += {c};
  EndFor
  ll = newll;  Curve Loop(ll) = {loop()};
  surf = news;  Plane Surface(surf) = {ll};
  If (w1 != w0)
    If (plane == 0)
      out() = Extrude {0, 0, w1 - w0} { Surface{surf}; };
    ElseIf (plane == 1)
      out() = Extrude {w1 - w0, 0, 0} { Surface{surf}; };
    Else
      out() = Extrude {0, w1 - w0, 0} { Surface{surf}; };
    EndIf
    vol = out(1);
  EndIf
Return

// A round hole whose wall is four quarter cylinders, so that it can be meshed regularly. In: hx, hy, hr, w0, w1. Out: vol.
Macro Drill
  p = newp;
  Point(p) = {hx, hy, w0};
  Point(p + 1) = {hx + hr, hy, w0};  Point(p + 2) = {hx, hy + hr, w0};
  Point(p + 3) = {hx - hr, hy, w0};  Point(p + 4) = {hx, hy - hr, w0};
  c = newl;
  Circle(c) = {p + 1, p, p + 2};      Circle(c + 1) = {p + 2, p, p + 3};
  Circle(c + 2) = {p + 3, p, p + 4};  Circle(c + 3) = {p + 4, p, p + 1};
  ll = newll;  Curve Loop(ll) = {c, c + 1, c + 2, c + 3};
  surf = news;  Plane Surface(surf) = {ll};
  out() = Extrude {0, 0, w1 - w0} { Surface{surf}; };
  vol = out(1);
Return

// A ring about (0, cy, .) or, where rr is 0, a cylinder. In: cy, rr, rR, w0, w1. Out: vol.
Macro Ring
  vol = newv;  Cylinder(vol) = {0, cy, w0, 0, 0, w1 - w0, rR};
  If (rr > 0)
    v2 = newv;  Cylinder(v2) = {0, cy, 2*w0 - w1, 0, 0, 3*(w1 - w0), rr};
    out() = BooleanDifference { Volume{vol}; Delete; }{ Volume{v2}; Delete; };
    vol = out(0);
  EndIf
Return

// ---------------------------------------------------------------------------------------------------------------- disc
z1 = disc_t / 2;  z0 = z1 - cheek_t;
If (extruded_disc == 0)
  // the solid, revolved, less the gap between the vanes
  pu() = {disc_R, disc_R, rub_r, hat_R,   hat_R, bore_R, bore_R,        hat_R - hat_t, hat_R - hat_t, cheek_r, cheek_r};
  pv() = {-z1,    z1,     z1,    z1 - 2,  hat_z, hat_z,  hat_z - hat_t, hat_z - hat_t, z0,            z0,      -z1};
  pr() = {0,      0,      0,     5,       10,    0,      0,             6,             0,             0,       0};
  plane = 2;  w0 = 0;  w1 = 0;  Call RoundPoly;
  out() = Extrude { {0, 0, 1}, {0, 0, 0}, 2*Pi } { Surface{surf}; };
  disc = out(1);
  Recursive Delete { Surface{surf}; }
  cy = 0;  rr = hat_R - hat_t - 5;  rR = disc_R + 10;  w0 = -z0;  w1 = z0;  Call Ring;
  boxes() = {};
  For i In {0:vanes-1}
    v = newv;  Box(v) = {vane_r0, -vane_t/2, -z0, vane_r1 - vane_r0, vane_t, 2*z0};
    Rotate { {0, 0, 1}, {0, 0, 0}, 2*Pi*(i + 0.5)/vanes + Pi/2 } { Volume{v}; }
    boxes() += {v};
  EndFor
  gap() = BooleanDifference { Volume{vol}; Delete; }{ Volume{boxes()}; Delete; };
  out() = BooleanDifference { Volume{disc}; Delete; }{ Volume{gap()}; Delete; };
  disc = out(0);
  holes() = {};
  For i In {0:hub_n-1}
    a = 2*Pi*i/hub_n + Pi/2;
    hx = hub_pcd/2*Cos(a);  hy = hub_pcd/2*Sin(a);  hr = hub_d/2;  w0 = hat_z - 20;  w1 = hat_z + 20;  Call Drill;
    holes() += {vol};
  EndFor
  disc() = BooleanDifference { Volume{disc}; Delete; }{ Volume{holes()}; Delete; };
Else
  // The plan: rings, bolt holes and vanes, each a region.
  s = news;  Disk(s) = {0, 0, -z1, disc_R};
  radii() = {cheek_r, hat_R, hat_R - hat_t, bore_R};
  plan() = {};
  For i In {0:#radii()-1}
    v = news;  Disk(v) = {0, 0, -z1, radii(i)};  plan() += {v};
  EndFor
  For i In {0:hub_n-1}
    a = 2*Pi*i/hub_n + Pi/2;
    v = news;  Disk(v) = {hub_pcd/2*Cos(a), hub_pcd/2*Sin(a), -z1, hub_d/2};  plan() += {v};
  EndFor
  For i In {0:vanes-1}
    v = news;  Rectangle(v) = {vane_r0, -vane_t/2, -z1, vane_r1 - vane_r0, vane_t};
    Rotate { {0, 0, 1}, {0, 0, 0}, 2*Pi*(i + 0.5)/vanes + Pi/2 } { Surface{v}; }
    plan() += {v};
  EndFor
  plan() = BooleanFragments { Surface{s}; Delete; }{ Surface{plan()}; Delete; };
  If (hexahedra)
    MeshAlgorithm Surface{plan()} = 5;  Recombine Surface{plan()};
  EndIf
  // Layer by layer; which volumes of a layer are solid follows from the region's extent.
  levels() = {-z1, -z0, z0, z1 - 2, z1, hat_z - hat_t, hat_z};
  disc() = {};
  layer() = plan();
  For l In {0:#levels()-2}
    w0 = levels(l);  w1 = levels(l + 1);
    If (hexahedra)
      Extrude {0, 0, w1 - w0} { Surface{layer()}; Layers{Ceil((w1 - w0) / h_disc)}; Recombine; }
    Else
      Extrude {0, 0, w1 - w0} { Surface{layer()}; }
    EndIf
    near() = Volume In BoundingBox {-disc_R - 1, -disc_R - 1, w0 - 0.05, disc_R + 1, disc_R + 1, w1 + 0.05};
    For i In {0:#near()-1}
      b() = BoundingBox Volume{near(i)};
      r = (b(3) - b(0)) / 2;
      If (Sqrt((b(3) + b(0))^2 + (b(4) + b(1))^2) / 2 > 100)
        solid = (l < 4);                  // a vane, and the cheeks over and under it
      ElseIf (Abs(b(3) + b(0)) > 1 || Abs(b(4) + b(1)) > 1)
        solid = 0;                        // a bolt hole
      ElseIf (r > cheek_r + 1)
        solid = (l == 0 || l == 2 || l == 3);
      ElseIf (r > hat_R + 1)
        solid = (l == 2);
      ElseIf (r > hat_R - hat_t + 1)
        solid = (l >= 2);
      Else
        solid = (l == 5 && r > bore_R + 1);
      EndIf
      If (solid)
        disc() += {near(i)};
      EndIf
    EndFor
    r = (l < 3) ? disc_R : hat_R;
    layer() = Surface In BoundingBox {-r - 1, -r - 1, w1 - 0.05, r + 1, r + 1, w1 + 0.05};
  EndFor
EndIf

// ---------------------------------------------------------------------------------------------------- outline of a finger plate
// (the caliper's and, as an imprint, the outer backplate's)
fpu() = {  52,  52,  45,  38,  16,  16, -16, -16, -38, -45, -52, -52};
fpv() = { 146, 120, 98,   93,  93, 122, 122,  93,  93, 98,  120, 146};
fpr() = {   0,   0,   8,   0,   5,  13,  13,   5,   0,   8,   0,   0};

// ---------------------------------------------------------------------------------------------------------------- pads
// Backplate and lining are fragmented together and share nodes. The back of the backplate carries an imprint of what
// touches it (the piston's ring, the fingers), so that a slave surface is exactly the touching zone.
// In: s = -1 inner, +1 outer. Out: lining, plate.
Macro Pad
  // backplate
  y0 = Sqrt(bp_r^2 - bp_x0^2);  y1 = Sqrt(bp_R^2 - bp_x1^2);
  m = (bp_x1 - bp_x0) / (y1 - y0);
  pu() = {bp_x0 + m*(60 - y0), bp_x0 + m*(150 - y0), -bp_x0 - m*(150 - y0), -bp_x0 - m*(60 - y0)};
  pv() = {60, 150, 150, 60};  pr() = {0, 0, 0, 0};
  plane = 0;  w0 = s*z_lin;  w1 = s*z_back;  Call RoundPoly;
  trap = vol;
  cy = 0;  rr = bp_r;  rR = bp_R;  Call Ring;
  out() = BooleanIntersection { Volume{trap}; Delete; }{ Volume{vol}; Delete; };
  plate = out(0);
  ears() = {};
  For e In {-1:1:2}
    pu() = {e*40, e*50, e*ear_x0, e*ear_x1, e*ear_x1, e*ear_x0, e*50, e*40};
    pv() = {ear_y0 - 4.5, ear_y0 - 4.5, ear_y0, ear_y0, ear_y1, ear_y1, ear_y1 + 4.5, ear_y1 + 4.5};
    pr() = {0, 0, 0, 0, 0, 0, 0, 0};
    Call RoundPoly;
    ears() += {vol};
  EndFor
  out() = BooleanUnion { Volume{plate}; Delete; }{ Volume{ears()}; Delete; };
  plate = out(0);
  // lining
  y0 = Sqrt(lin_r^2 - lin_x0^2);  y1 = Sqrt(lin_R^2 - lin_x1^2);
  m = (lin_x1 - lin_x0) / (y1 - y0);
  pu() = {lin_x0 + m*(60 - y0), lin_x0 + m*(150 - y0), -lin_x0 - m*(150 - y0), -lin_x0 - m*(60 - y0)};
  pv() = {60, 150, 150, 60};  pr() = {0, 0, 0, 0};
  w0 = s*z_rub;  w1 = s*z_lin;  Call RoundPoly;
  trap = vol;
  cy = 0;  rr = lin_r;  rR = lin_R;  Call Ring;
  out() = BooleanIntersection { Volume{trap}; Delete; }{ Volume{vol}; Delete; };
  lining = out(0);
  cuts() = {};
  v = newv;  Box(v) = {-slot_w/2, 60, s*(z_rub + slot_d) - (s > 0 ? 20 : 0), slot_w, 90, 20};
  cuts() += {v};
  For e In {-1:1:2}
    x = lin_x0 + m*(60 - y0);
    p = newp;
    Point(p)     = {e*(x - cham_w - 2*cham_w/cham_d), 60, s*(z_rub - 2)};
    Point(p + 1) = {e*(x + 4),                        60, s*(z_rub - 2)};
    Point(p + 2) = {e*(x + 4),                        60, s*(z_rub + cham_d*(1 + 4/cham_w))};
    c = newl;
    Line(c) = {p, p + 1};  Line(c + 1) = {p + 1, p + 2};  Line(c + 2) = {p + 2, p};
    ll = newll;  Curve Loop(ll) = {c, c + 1, c + 2};
    sf = news;  Plane Surface(sf) = {ll};
    out() = Extrude {e*m*90, 90, 0} { Surface{sf}; };
    cuts() += {out(1)};
  EndFor
  out() = BooleanDifference { Volume{lining}; Delete; }{ Volume{cuts()}; Delete; };
  lining = out(0);
  // imprint
  If (s < 0)
    tool = news;  Disk(tool) = {0, pis_y, -z_back, pis_R};
    t2 = news;  Disk(t2) = {0, pis_y, -z_back, pis_r};
    imprint() = {tool, t2};
  Else
    pu() = fpu();  pv() = fpv();  pr() = fpr();  w0 = z_back;  w1 = z_back;  Call RoundPoly;
    t2 = news;  Disk(t2) = {0, 0, z_back, bp_R};
    imprint() = BooleanIntersection { Surface{surf}; Delete; }{ Surface{t2}; Delete; };
  EndIf
  out() = BooleanFragments { Volume{lining, plate}; Delete; }{ Surface{imprint()}; Delete; };
  lining = out(0);  plate = out(1);
Return
s = -1;  Call Pad;
lining_inner = lining;  plate_inner = plate;
s = 1;   Call Pad;
lining_outer = lining;  plate_outer = plate;

// -------------------------------------------------------------------------------------------------------------- piston
// The wall is split where it enters the bore: `piston_side` is the part that the bore guides.
Geometry.OCCUnionUnify = 0;
cy = pis_y;  rr = pis_r;  rR = pis_R;  w0 = -z_back;  w1 = cyl_z1;  Call Ring;
piston = vol;
rr = pis_r;  w0 = cyl_z1;  w1 = -z_back - pis_l + pis_floor;  Call Ring;
v3 = vol;
rr = 0;  w0 = w1;  w1 = -z_back - pis_l;  Call Ring;
out() = BooleanUnion { Volume{piston}; Delete; }{ Volume{v3, vol}; Delete; };
piston = out(0);
Geometry.OCCUnionUnify = 1;

// ------------------------------------------------------------------------------------------------------------- caliper
z_fin = z_back + fin_t;
plane = 0;
// bridge
pu() = {56, 56, 34, -34, -56, -56};  pv() = {120, 152, 163, 163, 152, 120};  pr() = {0, 8, 12, 12, 8, 0};
w0 = lug_z0;  w1 = z_fin;  Call RoundPoly;
bridge = vol;
cy = 0;  rr = 0;  rR = bri_r;  w0 = -100;  w1 = 100;  Call Ring;
v = newv;  Box(v) = {-20, 120, -20, 40, 60, 40};                       // window
pu() = {146, 180, 180};  pv() = {-80, -80, -22};  pr() = {0, 0, 0};  // slope above the housing
plane = 1;  w0 = -70;  w1 = 70;  v3 = vol;  Call RoundPoly;
out() = BooleanDifference { Volume{bridge}; Delete; }{ Volume{v3, vol, v}; Delete; };
bridge = out(0);
plane = 0;
// fingers
pu() = fpu();  pv() = fpv();  pr() = fpr();  w0 = z_back;  w1 = z_fin;  Call RoundPoly;
fingers = vol;
// shoulders between the housing and the bridge
pu() = {50, 56, 56, 33, -33, -56, -56, -50};  pv() = {147, 143, 126, 96, 96, 126, 143, 147};  pr() = {0, 0, 0, 0, 0, 0, 0, 0};
w0 = lug_z0;  w1 = cyl_z1;  Call RoundPoly;
shoulder = vol;
// housing
cy = pis_y;  rr = 0;  rR = cyl_R;  w0 = cyl_z0;  w1 = cyl_z1;  Call Ring;
house = vol;
// lugs
lugs() = {};
For e In {-1:1:2}
  pu() = {0, e*91, e*91, e*74, 0};  pv() = {144, 144, 122, 122, 88};  pr() = {0, 9, 9, 8, 0};
  w0 = lug_z0;  w1 = lug_z1;  Call RoundPoly;
  lugs() += {vol};
EndFor
out() = BooleanUnion { Volume{bridge}; Delete; }{ Volume{fingers, shoulder, house, lugs()}; Delete; };
caliper = out(0);
cy = pis_y;  rr = 0;  rR = pis_R;  w0 = bore_z;  w1 = cyl_z1 + 5;  Call Ring;
cuts() = {vol};
For e In {-1:1:2}
  hx = e*pin_x;  hy = pin_y;  hr = pin_R;  w0 = lug_z0 - 5;  w1 = lug_z1 + 5;  Call Drill;
  cuts() += {vol};
EndFor
out() = BooleanDifference { Volume{caliper}; Delete; }{ Volume{cuts()}; Delete; };
caliper = out(0);

// ------------------------------------------------------------------------------------------------------------- bracket
plane = 0;  arms() = {};
For e In {-1:1:2}
  // column over the rim, with the channel for the ears
  pu() = {e*ear_x0, e*ear_x0, e*ear_x1, e*ear_x1, e*ear_x0, e*ear_x0, e*69,  e*91,  e*91,  e*86, e*75};
  pv() = {56,       ear_y0,   ear_y0,   ear_y1,   ear_y1,   136,      146,   146,   118,   96,   56};
  pr() = {0,        0,        0,        0,        0,        0,        0,     11,    20,    20,   0};
  w0 = -brk_z;  w1 = brk_z;  Call RoundPoly;
  cy = 0;  v1 = vol;  rr = 0;  rR = brk_r;  w0 = -brk_gap;  w1 = brk_gap;  Call Ring;
  out() = BooleanDifference { Volume{v1}; Delete; }{ Volume{vol}; Delete; };
  arms() += {out(0)};
  // pin boss
  pu() = {e*69, e*91, e*91, e*84, e*69};  pv() = {146, 146, 128, 121, 121};  pr() = {0, 11, 0, 0, 0};
  w0 = boss_z;  w1 = -brk_z;  Call RoundPoly;
  arms() += {vol};
  // inboard leg with the mounting bolt
  pu() = {e*55, e*ear_x0, e*78, e*82, e*81, e*55};
  pv() = {66,   86,       86,   70,   33,   33};
  pr() = {0,    0,        0,    0,    10,   10};
  w0 = -brk_z;  w1 = -brk_gap;  Call RoundPoly;
  arms() += {vol};
EndFor
// inboard cross-bar below the inner pad, outboard tie bar between hat and outer pad
For e In {-1:1:2}
  cy = 0;  rr = (e < 0) ? 64 : hat_R + 3;  rR = 88;
  w0 = (e < 0) ? -brk_z : 17;  w1 = (e < 0) ? -21 : 29;  Call Ring;
  v1 = vol;
  pu() = {-66, -66, 66, 66};  pv() = {(e < 0) ? 46 : 56, 95, 95, (e < 0) ? 46 : 56};
  pr() = {0, 0, 0, 0};  Call RoundPoly;
  out() = BooleanIntersection { Volume{v1}; Delete; }{ Volume{vol}; Delete; };
  arms() += {out(0)};
EndFor
v1 = arms(0);
out() = BooleanUnion { Volume{v1}; Delete; }{ Volume{arms({1:#arms()-1})}; Delete; };
bracket = out(0);
cuts() = {};
For e In {-1:1:2}
  hx = e*pin_x;  hy = pin_y;  hr = pin_R;  w0 = boss_z - 5;  w1 = pinhole_z;  Call Drill;
  cuts() += {vol};
  hx = e*bolt_x;  hy = bolt_y;  hr = bolt_R;  w0 = -brk_z - 5;  w1 = 0;  Call Drill;
  cuts() += {vol};
EndFor
out() = BooleanDifference { Volume{bracket}; Delete; }{ Volume{cuts()}; Delete; };
bracket = out(0);
Printf("parts: %g %g %g %g %g %g %g %g", disc(0), lining_inner, plate_inner, lining_outer, plate_outer, piston, caliper, bracket);

// ---------------------------------------------------------------------------------------------------------------- names
Physical Volume("disc") = {disc()};
Physical Volume("lining_inner") = {lining_inner};
Physical Volume("backplate_inner") = {plate_inner};
Physical Volume("lining_outer") = {lining_outer};
Physical Volume("backplate_outer") = {plate_outer};
Physical Volume("piston") = {piston};
Physical Volume("caliper") = {caliper};
Physical Volume("bracket") = {bracket};

// Faces of a part within a box. In: part, and the box x0 y0 z0 to x1 y1 z1 (grown by tol). Out: found().
tol = 0.05;
Macro Faces
  near() = Surface In BoundingBox {bx0 - tol, by0 - tol, bz0 - tol, bx1 + tol, by1 + tol, bz1 + tol};
  own() = Abs(CombinedBoundary { Volume{part()}; });
  found() = {};
  For i In {0:#near()-1}
    For j In {0:#own()-1}
      If (near(i) == own(j))
        found() += {near(i)};
      EndIf
    EndFor
  EndFor
  If (#found() == 0)
    Error("no face of part %g in the box (%g %g %g) (%g %g %g)", part(0), bx0, by0, bz0, bx1, by1, bz1);
  EndIf
Return

// disc
part() = disc();  bx0 = -disc_R;  bx1 = disc_R;  by0 = -disc_R;  by1 = disc_R;
bz0 = -z_rub;  bz1 = -z_rub;  Call Faces;
Physical Surface("disc_inner_face") = found();
bz0 = z_rub;  bz1 = z_rub;  Call Faces;
Physical Surface("disc_outer_face") = found();
all() = {};
For h In {0:hub_n-1}
  a = 2*Pi*h/hub_n + Pi/2;  x = hub_pcd/2*Cos(a);  y = hub_pcd/2*Sin(a);
  bx0 = x - hub_d/2;  bx1 = x + hub_d/2;  by0 = y - hub_d/2;  by1 = y + hub_d/2;  bz0 = hat_z - hat_t;  bz1 = hat_z;  Call Faces;
  all() += {found()};
EndFor
Physical Surface("hub_bolts") = all();
bolts() = all();

// pads
bx0 = -100;  bx1 = 100;  by0 = 60;  by1 = 150;
part() = {lining_inner};  bz0 = -z_rub;  bz1 = -z_rub;  Call Faces;
Physical Surface("lining_inner_face") = found();
part() = {lining_outer};  bz0 = z_rub;  bz1 = z_rub;  Call Faces;
Physical Surface("lining_outer_face") = found();
// the ring under the piston: what lies within the piston's radius, without the disc inside
part() = {plate_inner};  bx0 = -pis_R;  bx1 = pis_R;  by0 = pis_y - pis_R;  by1 = pis_y + pis_R;  bz0 = -z_back;  bz1 = -z_back;  Call Faces;
ring() = found();
bx0 = -pis_r;  bx1 = pis_r;  by0 = pis_y - pis_r;  by1 = pis_y + pis_r;  Call Faces;
ring() -= {found()};
Physical Surface("backplate_inner_back") = ring();
part() = {plate_outer};  by0 = 92;  by1 = bp_R;  bz0 = z_back;  bz1 = z_back;  bx0 = -52;  bx1 = 52;  Call Faces;
Physical Surface("backplate_outer_back") = found();

// ears and abutments: the end face and both radial faces
Macro Ears
  all() = {};
  bx0 = (e < 0) ? -ear_x1 : ear_x0;  bx1 = (e < 0) ? -ear_x0 : ear_x1;
  by0 = ear_y0;  by1 = ear_y0;  Call Faces;
  all() += {found()};
  by0 = ear_y1;  by1 = ear_y1;  Call Faces;
  all() += {found()};
  bx0 = e*ear_x1;  bx1 = e*ear_x1;  by0 = ear_y0;  Call Faces;
  all() += {found()};
Return
e = -1;
part() = {plate_inner};  bz0 = -z_back;  bz1 = -z_lin;  Call Ears;
Physical Surface("pad_inner_left") = all();
part() = {plate_outer};  bz0 = z_lin;  bz1 = z_back;  Call Ears;
Physical Surface("pad_outer_left") = all();
part() = {bracket};  bz0 = -brk_z;  bz1 = -brk_gap;  Call Ears;
Physical Surface("bracket_inner_left") = all();
part() = {bracket};  bz0 = brk_gap;  bz1 = brk_z;  Call Ears;
Physical Surface("bracket_outer_left") = all();
e = 1;
part() = {plate_inner};  bz0 = -z_back;  bz1 = -z_lin;  Call Ears;
Physical Surface("pad_inner_right") = all();
part() = {plate_outer};  bz0 = z_lin;  bz1 = z_back;  Call Ears;
Physical Surface("pad_outer_right") = all();
part() = {bracket};  bz0 = -brk_z;  bz1 = -brk_gap;  Call Ears;
Physical Surface("bracket_inner_right") = all();
part() = {bracket};  bz0 = brk_gap;  bz1 = brk_z;  Call Ears;
Physical Surface("bracket_outer_right") = all();

// piston and bore
bx0 = -pis_R;  bx1 = pis_R;  by0 = pis_y - pis_R;  by1 = pis_y + pis_R;
part() = {piston};  bz0 = -z_back;  bz1 = -z_back;  Call Faces;
Physical Surface("piston_face") = found();
bz0 = -z_back - pis_l;  bz1 = -z_back - pis_l;  Call Faces;
Physical Surface("piston_floor") = found();
bz1 = cyl_z1;  Call Faces;  // wall, floor and, without it, the wall alone
wall() = found();
bz1 = bz0;  Call Faces;
wall() -= {found()};
bx0 = -pis_r;  bx1 = pis_r;  by0 = pis_y - pis_r;  by1 = pis_y + pis_r;  bz1 = cyl_z1;  Call Faces;
wall() -= {found()};
Physical Surface("piston_side") = wall();
part() = {caliper};  bx0 = -pis_R;  bx1 = pis_R;  by0 = pis_y - pis_R;  by1 = pis_y + pis_R;
bz0 = bore_z;  bz1 = bore_z;  Call Faces;
floor() = found();
Physical Surface("caliper_bore_floor") = floor();
bz1 = cyl_z1;  Call Faces;
wall() = found();
wall() -= {floor()};
Physical Surface("caliper_bore_wall") = wall();
bore() = wall();
bx0 = -60;  bx1 = 60;  by0 = 90;  by1 = 170;  bz0 = z_back;  bz1 = z_back;  part() = {caliper};  Call Faces;
Physical Surface("caliper_fingers") = found();

// pins and bolts
pins() = {};
by0 = pin_y - pin_R;  by1 = pin_y + pin_R;
bx0 = -pin_x - pin_R;  bx1 = -pin_x + pin_R;
part() = {caliper};  bz0 = lug_z0;  bz1 = lug_z1;  Call Faces;
Physical Surface("caliper_pin_left") = found();
pins() += {found()};
part() = {bracket};  bz0 = boss_z;  bz1 = pinhole_z;  Call Faces;
hole() = found();
bz0 = pinhole_z;  Call Faces;
hole() -= {found()};
Physical Surface("bracket_pin_left") = hole();
pins() += {hole()};
bx0 = pin_x - pin_R;  bx1 = pin_x + pin_R;
part() = {caliper};  bz0 = lug_z0;  bz1 = lug_z1;  Call Faces;
Physical Surface("caliper_pin_right") = found();
pins() += {found()};
part() = {bracket};  bz0 = boss_z;  bz1 = pinhole_z;  Call Faces;
hole() = found();
bz0 = pinhole_z;  Call Faces;
hole() -= {found()};
Physical Surface("bracket_pin_right") = hole();
pins() += {hole()};
all() = {};  bz0 = -brk_z;  bz1 = 0;  by0 = bolt_y - bolt_R;  by1 = bolt_y + bolt_R;
For e In {-1:1:2}
  bx0 = e*bolt_x - bolt_R;  bx1 = e*bolt_x + bolt_R;  Call Faces;
  all() += {found()};
EndFor
Physical Surface("bracket_bolts") = all();
mounts() = all();

// ---------------------------------------------------------------------------------------------------------------- mesh
MeshSize { PointsOf { Volume{disc()}; } } = h_disc;
MeshSize { PointsOf { Volume{caliper}; } } = h_caliper;
MeshSize { PointsOf { Volume{bracket}; } } = h_bracket;
MeshSize { PointsOf { Volume{piston}; } } = h_piston;
MeshSize { PointsOf { Volume{plate_inner, plate_outer}; } } = h_plate;
MeshSize { PointsOf { Volume{lining_inner, lining_outer}; } } = h_lining;
// walls of holes regularly: arcs of equal parts, lengths by the hole's own element size
walls() = {pins(), mounts()};
If (extruded_disc == 0)
  walls() += bolts();
EndIf
arcs = per_hole_(k) / 4;
For i In {0:#walls()-1}
  c() = Abs(Boundary { Surface{walls(i)}; });
  For j In {0:#c()-1}
    b() = BoundingBox Curve{c(j)};
    l = b(5) - b(2);
    If (l > 1)
      Transfinite Curve{c(j)} = 1 + Ceil(l / wall_h_(k));
    Else
      Transfinite Curve{c(j)} = 1 + arcs;
    EndIf
  EndFor
  Transfinite Surface{walls(i)};
  MeshSize { PointsOf { Surface{walls(i)}; } } = wall_h_(k);
EndFor
MeshSize { PointsOf { Surface{bore()}; } } = Min(2*Pi*pis_R/per_hole_(k), h_caliper);
// Elements over the height of a vane's edges. Where the vanes are finely meshed, both of their sides regularly but with
// other counts: where nodes of both sides lie in a plane they make slivers across the vane.
near() = {};
If (extruded_disc == 0)
  near() = Curve In BoundingBox {-disc_R - 1, -disc_R - 1, -z0 - 0.01, disc_R + 1, disc_R + 1, z0 + 0.01};
EndIf
For i In {0:#near()-1}
  b() = BoundingBox Curve{near(i)};
  a = (Atan2(b(1) + b(4), b(0) + b(3)) - Pi/2) / (2*Pi) * vanes + vanes;
  a = (a - Floor(a) > 0.5) ? 1 : 0;
  If (b(5) - b(2) > z0 && b(3) - b(0) < 0.1 && b(4) - b(1) < 0.1)
    Transfinite Curve{near(i)} = 1 + vane_n + ((size == 4) ? a : 0);
  ElseIf (size == 4 && b(5) - b(2) < 0.1 && Sqrt((b(3) - b(0))^2 + (b(4) - b(1))^2) > 0.9*(vane_r1 - vane_r0) && Sqrt((b(3) - b(0))^2 + (b(4) - b(1))^2) < 1.1*(vane_r1 - vane_r0))
    Transfinite Curve{near(i)} = 1 + Ceil((vane_r1 - vane_r0) / h_disc) + a;
  EndIf
EndFor
If (size == 4 && extruded_disc == 0)
  near() = Surface In BoundingBox {-disc_R - 1, -disc_R - 1, -z0 - 0.01, disc_R + 1, disc_R + 1, z0 + 0.01};
  For i In {0:#near()-1}
    b() = BoundingBox Surface{near(i)};
    l = Sqrt((b(3) - b(0))^2 + (b(4) - b(1))^2);
    If (b(5) - b(2) > z0 && l > 0.9*(vane_r1 - vane_r0) && l < 1.1*(vane_r1 - vane_r0))
      Transfinite Surface{near(i)} Alternate;
    EndIf
  EndFor
EndIf
Mesh.MeshSizeExtendFromBoundary = 1;
Mesh.MeshSizeFromPoints = 1;
Mesh.MeshSizeFromCurvature = per_turn_(k);
Mesh.Algorithm = (size == 1) ? 1 : 6;   // MeshAdapt copes better with very coarse strips, else frontal-Delaunay
Mesh.Algorithm3D = 1;             // Delaunay; HXT (10) is faster but in 4.8 not the same from run to run
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 0;
Mesh.SecondOrderIncomplete = 1;   // 20-node hexahedra, 15-node wedges
Mesh.HighOrderOptimize = 1;
Mesh.Optimize = 3;                // passes
Mesh.OptimizeThreshold = 0.35;
General.NumThreads = 1;           // one thread and the default random seed: the same mesh every time
Mesh.MaxNumThreads1D = 1;  Mesh.MaxNumThreads2D = 1;  Mesh.MaxNumThreads3D = 1;
Mesh.MshFileVersion = 4.1;
Mesh.Binary = 1;
Mesh.SaveAll = 0;
