# The program is C11 without a warning, and feels the floor that it made.
built="$(dirname "$(command -v knurld)")/../../runtime/capi"
cc -std=c11 -Wall -Wextra -Wpedantic -Werror "-I$REPOSITORY/runtime/capi/include" "-I$built/include" "$BLOCK" "-L$built" -lknurl \
    "-Wl,-rpath,$(realpath "$built")" -o wall
knurld --device right=sim:premium15 --priority 0 >said 2>&1 &
servo=$!
trap 'kill $servo; wait $servo || true' EXIT
./wall | tee felt
grep -qE 'mm, [0-9.]+ N' felt || { cat said; exit 1; }
