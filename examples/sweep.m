% A sweep over flow rate and mud density: submit, wait, table, one orbit, one spectrum. For R2021a and later.
server = "http://127.0.0.1:7340";
token = getenv("DRILLSWEEP_TOKEN");
header = [];
if ~isempty(token)
    header = ["Authorization", "Bearer " + token];
end
json = weboptions(MediaType="application/json", ContentType="json", Timeout=90, HeaderFields=header);
csv = weboptions(ContentType="table", Timeout=90, HeaderFields=header);

request = struct();
request.preset = "paper-200m-damped";
request.axes.flow_rate.values = [0.01 0.04 0.06];    % a single value would have to be a cell: {0.01}
request.axes.mud_density = struct("from", 1200, "to", 2100, "count", 4);
sweep = webwrite(server + "/v1/sweeps", request, json);

while ~isfield(sweep, "finished")                    % held back by the server until something changes
    sweep = webread(server + "/v1/sweeps/" + sweep.id, "wait", "30s", json);
    fprintf("%3.0f %% of %d points\n", 100 * sweep.progress, sweep.counts.total);
end

path = server + "/v1/sweeps/" + sweep.id;
results = webread(path + "/table", "format", "csv", csv);
disp(results(:, ["flow_rate", "mud_density", "friction_coefficient_max", "orbit_radius_rms_57_7m"]));

orbit = webread(path + "/points/1/orbit", "depth", 57.7, "format", "csv", csv);
spectrum = webread(path + "/points/1/spectrum", "depth", 57.7, "window", "hann", "format", "csv", csv);
figure; plot(1e3 * orbit.u, 1e3 * orbit.v); axis equal; xlabel("u [mm]"); ylabel("v [mm]");
figure; plot(spectrum.frequency, 1e3 * spectrum.amplitude); xlabel("frequency [Hz]"); ylabel("amplitude [mm]");
