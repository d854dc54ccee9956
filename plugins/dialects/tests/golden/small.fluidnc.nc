(Carvegraph: Medallion: 50% draft "A")
(- Ball 6 mm, stepover 0.3 mm)
(- Zero: top, corner)
G17 G21 G90 G94
M5
(- tool 1: config.yaml must name an atc or an m6_macro, or M6 does nothing)
T1 M6
M3 S12000
G4 P3.0
G0 Z5.0
X10.0 Y20.0
(- first pass rough don't touch / O9000 _)
G1 Z-1.0 F200.0
X10.5 Z-1.25 F900.0
X11.0
X11.5 Y20.333 Z-1.0
G17
G2 X12.5 Y19.333 I0.0 J-1.0 F600.0
G3 X15.5 Y22.333 I3.0 J0.0
G2 X15.5 Y22.333 I0.0 J-2.333
G3 X13.167 Y20.0 Z-2.0 I0.0 J-2.333
G18
X14.167 Z-3.0 I1.0 K0.0
G0 Z5.0
M5
(- tool 2: config.yaml must name an atc or an m6_macro, or M6 does nothing)
T2 M6
M3 S8000
G4 P3.0
G0 Z2.0
X30.0 Y20.0
G1 Z-1.0 F200.0
X31.0
G4 P0.5
(- G0 Z-50 then "M3" %)
G19
G3 Y22.0 Z-1.0 J1.0 K0.0 F600.0
G0 Z5.0
M5
M30
