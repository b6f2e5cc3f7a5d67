# All three forms of an asset are read and built; the mesh is a tetrahedron.
cat >bunny.ply <<'PLY'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
100 0 0
0 100 0
0 0 100
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
PLY
cp "$BLOCK" scene.toml
printf 't,x,y,z\n0,0.01,0.01,0.2\n1,0.01,0.01,0.1\n' >motion.csv
knurl eval --scene scene.toml --motion motion.csv --out felt.csv
test "$(wc -l <felt.csv)" -gt 100
