(Carvegraph: Medallion)
(- Ball 6 mm, stepover 0.3 mm)
(- Zero: top, corner)
G17 G21 G90 G94
M3 S12000
G4 P3.0
G0 Z5.0
X10.0 Y20.0
(- first pass)
G1 Z-1.0 F200.0
X10.5 Z-1.25 F900.0
X11.0
X11.5 Y20.333 Z-1.0
G2 X12.5 Y19.333 I0.0 J-1.0 F600.0
G18
G3 X13.5 Z-2.0 I1.0 K0.0
G0 Z5.0
X30.0 Y20.0
Z2.0
G1 Z-1.0 F200.0
X31.0
G4 P0.5
G0 Z5.0
M5
M30
