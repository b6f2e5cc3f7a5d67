# A servo starts with it, under that name, and clients find it.
sed '/^socket_group/d; /^idle/d' "$BLOCK" >lab.toml   # the group need not be there, nor the right to keep CPUs awake
grep -q '^socket_group' "$BLOCK"
knurld --config lab.toml --priority 0 >said 2>&1 &
servo=$!
trap 'kill $servo; wait $servo || true' EXIT
for ((i = 0; i < 200; ++i)); do
    knurl ls >listed 2>&1 || true
    if grep -q 'knurl:lab' listed && grep -q 'of 2 N' listed; then exit 0; fi
    kill -0 $servo || break
    sleep 0.1
done
cat said listed
exit 1
