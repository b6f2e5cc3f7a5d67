# Six lines feel a wall; they go on for ever, so an interrupt ends them, as it does at a terminal.
built="$(dirname "$(command -v knurld)")/../.."
knurld --device right=sim:premium15 --priority 0 >said 2>&1 &
servo=$!
trap 'kill $servo; wait $servo || true' EXIT
export PYTHONPATH="$built/bindings/python" KNURL_LIBRARY_DIR="$built/runtime/capi" PYTHONUNBUFFERED=1
env --default-signal=INT /usr/bin/python3 "$BLOCK" >felt 2>ended &
wall=$!
for ((i = 0; i < 200; ++i)); do
    if grep -qE 'mm, [0-9.]*[1-9][0-9]* N' felt; then break; fi
    kill -0 $wall || break
    sleep 0.1
done
kill -INT $wall || true
wait $wall || true
grep -E 'mm, [0-9.]*[1-9][0-9]* N' felt | head -1 || { cat said felt ended; exit 1; }
