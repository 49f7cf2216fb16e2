// A bracket with two bolt holes, in millimetres: gmsh draws it, cmverify reads it.
Point(1) = {0, 0, 0}; Point(2) = {120, 0, 0}; Point(3) = {120, 40, 0}; Point(4) = {60, 40, 0};
Point(5) = {40, 60, 0}; Point(6) = {40, 120, 0}; Point(7) = {0, 120, 0}; Point(8) = {60, 60, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Circle(4) = {4, 8, 5};
Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 1};
Point(10) = {95, 20, 0}; Point(11) = {103, 20, 0}; Point(12) = {87, 20, 0};
Circle(8) = {11, 10, 12}; Circle(9) = {12, 10, 11};
Point(20) = {20, 95, 0}; Point(21) = {28, 95, 0}; Point(22) = {12, 95, 0};
Circle(10) = {21, 20, 22}; Circle(11) = {22, 20, 21};
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7}; Curve Loop(2) = {8, 9}; Curve Loop(3) = {10, 11};
Plane Surface(1) = {1, 2, 3};
