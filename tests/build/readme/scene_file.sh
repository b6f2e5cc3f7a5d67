# The scene is read, and played along a motion.
printf 't,x,y,z\n0,0,0,0.01\n3,0,0,-0.002\n' >motion.csv
knurl eval --scene "$BLOCK" --motion motion.csv --out felt.csv
test "$(wc -l <felt.csv)" -gt 100
