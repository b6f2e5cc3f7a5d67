% A floor that the hand touches from above, in Octave. Prints what is felt.
%     octave-cli wall.m 30
% The first time it compiles knurl_mex.c beside it (Debian: octave-dev, libknurl-dev). KNURL_FLAGS: where headers and library
% are, if not where the compiler looks.

here = fileparts(mfilename("fullpath"));
built = getenv("KNURL_MEX");  % folder for what is compiled
if isempty(built)
    built = here;
endif
addpath(built);
if exist("knurl_mex") != 3
    flags = strsplit(strtrim([getenv("KNURL_FLAGS") " -lknurl"]));
    [text, failed] = mkoctfile("--mex", flags{:}, "-o", fullfile(built, "knurl_mex.mex"), fullfile(here, "knurl_mex.c"));
    if failed
        error("knurl_mex.c: %s", text);
    endif
    rehash();
endif

seconds = 30;
arguments = argv();
if numel(arguments) > 0 && !isnan(str2double(arguments{end}))
    seconds = str2double(arguments{end});
endif

hand = knurl_mex("claim");
centre = knurl_mex("centre", hand);
id = knurl_mex("add_plane", hand, centre(3) + 0.002, 800);  % m: the hand at rest is 2 mm within; N/m
knurl_mex("arm", hand);
most = 0;
start = tic();
while toc(start) < seconds
    knurl_mex("commit", hand);  % "I am alive", and a cycle passes
    force = knurl_mex("force", hand, id);
    most = max(most, force(3));
endwhile
knurl_mex("close");
printf("felt up to %.2f N\n", most);
