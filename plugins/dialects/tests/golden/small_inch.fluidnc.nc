(Carvegraph: Medallion: 50% draft "A")
(- Ball 6 mm, stepover 0.3 mm)
(- Zero: top, corner)
G17 G20 G90 G94
M5
(- tool 1: config.yaml must name an atc or an m6_macro, or M6 does nothing)
T1 M6
M3 S12000
G4 P3.0
G0 Z0.1969
X0.3937 Y0.7874
(- first pass rough don't touch / O9000 _)
G1 Z-0.0394 F7.874
X0.4134 Z-0.0492 F35.4331
X0.4331
X0.4528 Y0.8005 Z-0.0394
G17
G2 X0.4921 Y0.7612 I0.0 J-0.0393 F23.622
G3 X0.6102 Y0.8793 I0.1181 J0.0
G2 X0.6102 Y0.8793 I0.0 J-0.0919
G3 X0.5184 Y0.7874 Z-0.0787 I0.0001 J-0.0919
G18
X0.5577 Z-0.1181 I0.0394 K0.0
G0 Z0.1969
M5
(- tool 2: config.yaml must name an atc or an m6_macro, or M6 does nothing)
T2 M6
M3 S8000
G4 P3.0
G0 Z0.0787
X1.1811 Y0.7874
G1 Z-0.0394 F7.874
X1.2205
G4 P0.5
(- G0 Z-50 then "M3" %)
G19
G3 Y0.8661 Z-0.0394 J0.0393 K0.0 F23.622
G0 Z0.1969
M5
M30
