# The arm is read, and can be felt with.
cp "$BLOCK" mine.toml
knurl device check mine.toml
