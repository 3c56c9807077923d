% The loop of elevator-2khz under robust, closed from the matrices in pitch.mat; for MATLAB and Octave, without a toolbox.
%
% Made by forcefeel for the loader with the SHA-256 8a092bbfbd4a2f34...
% It closes the loop, compares the column's response to 1 N of pilot force with what the engine of forcefeel gives, and the pole that is
% nearest to the edge; an error if one differs. SI units.
%
% The linear models leave out amplifier.current_limit, valve.orifice, valve.flow_limit and 8 more of the loader's optional rows; forcefeel simulate has all of it in play.

file = load(fullfile(fileparts(mfilename('fullpath')), 'pitch.mat'));
A = file.plant_A; B = file.plant_B; C = file.plant_C;  % inputs: pilot force, command
n = size(A, 1);
good = true;
for setting = 1:size(file.feel, 1)
  inertia = file.feel(setting, 1); damping = file.feel(setting, 2); stiffness = file.feel(setting, 3);
  F = [0, 1; -stiffness / inertia, -damping / inertia]; G = [0; 1 / inertia];
  T = file.period_s; tau = file.delay_s;
  % x+ = Phi x + Gamma_0 e_old + Gamma_1 e + Gamma_F F_p: the new command acts over the last T - tau, the old one over the first tau
  over = expm([A, B; zeros(2, n + 2)] * T);
  late = expm([A, B; zeros(2, n + 2)] * (T - tau));
  first = expm([A, B; zeros(2, n + 2)] * tau);
  Phi = over(1:n, 1:n); by_force = over(1:n, n + 1); new = late(1:n, n + 2); old = late(1:n, 1:n) * first(1:n, n + 2);
  feel = expm([F, G; 0, 0, 0] * T);
  % T = t [xi; y; delta; delta'],  e = c [xi; y; delta; delta'],  xi+ = a xi + b [y; e]
  a = file.law_transition(:, :, setting); b = file.law_input(:, :, setting);
  m = size(a, 1);
  c = reshape(file.law_command(:, setting), 1, []); t = reshape(file.law_torque(:, setting), 1, []);
  on = @(row) [row(m + 1:m + 3) * C, 0, row(1:m), row(m + 4:m + 5)];  % on [x; e_old; xi; delta; delta']
  matrix = blkdiag([Phi, old; zeros(1, n + 1)], a, feel(1:2, 1:2));
  matrix(n + 2:n + 1 + m, 1:n) = b(:, 1:3) * C;
  matrix = matrix + [new; 1; b(:, 4); 0; 0] * on(c) + [zeros(n + 1 + m, 1); feel(1:2, 3)] * on(t);
  entry = [by_force; zeros(m + 3, 1)];
  must = file.expected_angle_rad(setting, :);
  x = zeros(size(matrix, 1), 1); found = zeros(size(must));
  for k = 1:numel(must)
    x = matrix * x + entry;
    found(k) = C(3, :) * x(1:n);
  end
  off = max(abs(found - must)) / max(abs(must));
  pole = max(abs(eig(matrix)));
  pole_must = file.expected_critical(setting);
  same = off <= 1e-5 && abs(pole - pole_must) <= 1e-6 * max(1, abs(pole_must));
  good = good && same;
  verdicts = {'DIFFERENT', 'the same'};
  fprintf('setting %d: response off by %.1e of its largest, pole %.9g (must be %.9g): %s\n', setting, off, pole, pole_must, verdicts{same + 1});
end
if ~good, error('the loop is another than the engine of forcefeel has'); end
