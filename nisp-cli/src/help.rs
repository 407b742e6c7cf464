//! What stands behind the options in `--help`.

/// Behind the short help of `solve`.
pub(crate) const SEE_HELP: &str =
    "Exit codes: 0 solved, 2 bad input, 3 not converged, 4 results elsewhere. `--help` has examples.";

/// Examples of the program `nisp`.
#[cfg(feature = "shipped")]
pub(crate) const EXAMPLES: &str = "\
  nisp solve pendulum
      the repository's noisy example, scored against its truth
  nisp solve pendulum --data run.csv --column q=q_m_sigma0.01 --set m0=0.05
      your measurements; the cart weighs 50 g
  nisp solve rlc --data volts.csv --set f0=6 --budget 4 --seed 3 --json > answer.json
  nisp solve pendulum --config run.toml --out results/run-7
  nisp solve membrane --sample y_shape_1.toml --cloud 2 --truth y_shape_1_truth.csv
      contact pressure on a membrane, from a cloud of the sample
  nisp solve membrane --scene identify --data bubble.ply --unit mm --set p=5670
      your cloud; nothing touches the membrane, and its modulus is wanted
  nisp solve sponge --data sides.ply --set force_z=2.4 --set force_x=0 ...
  nisp calibrate bubble --reference free.npy --set p=5256 --set a=0.057 --set b=0.04 --out sensor, then
  nisp solve bubble --calibration sensor/calibration.toml --data frame.npy --set p=5690
      a soft bubble seen by a depth camera: first its free shape, then a force
  nisp new cooling, then nisp solve cooling/cooling.pde --data cooling/data.csv
      an equation of your own, in a text file; `nisp new cooling --rust` writes a crate with this command line
  nisp solve heat.pde --data probes=probes.csv --data wall=wall.csv --grid 100x50
      a table for each group that was measured; the answer on a grid
  nisp solve plate --budget 600 --checkpoint
  nisp solve plate --budget 600 --checkpoint --resume nisp-out
      goes on where the first run stopped, or was stopped";

/// Behind the examples, in the long help of `solve`.
pub(crate) const TEACH: &str = "\
Data:
  A CSV with one header line, a column for each coordinate (one alone must rise) and for each observed quantity. A group
  of several, or one whose points are wanted from a table, is named before its file. For `q` in metres the headers
  `q`, `q [m]` and `q_m` are found by themselves; `q_mm` is converted. Any other header is chosen with --column. A
  header without a unit is taken in the declared one: `nisp explain SCENE` shows units and parameters. Files may have
  256 MiB; devices and pipes are not read.
  A group that lies in a domain draws its points by itself. A surface (`chamfer`) takes a cloud: --data GROUP=FILE, or
  GROUP.TERM=FILE.
  For contact, a cloud: PLY, PCD, NPY, NPZ, CSV or XYZ, in metres or the unit of --unit, in the frame of the sample
  (data/README.md). --column then names columns of the truth.

Configuration (every option has a key of the same name; paths are taken from the file's folder):
  data = \"run.csv\"
  column = { q = \"q_m_sigma0.01\" }
  set = { m0 = 0.05 }
  budget = 4.0

Results, in the folder of --out:
  source.csv  the recovered source with its standard deviation, where the method gives one
  state.csv   the fields, likewise
  plot.svg    both, with measurements, truth and a band of two standard deviations
  answer.nisp the answer itself: `nisp eval` reads values, derivatives and declared expressions anywhere, without data
  Over three coordinates also volume.vtu; of an answer that is inconsistent misfits.csv and, over one and two
  coordinates, misfits.svg: what is left of every measurement, at its place.
  For contact also surface.svg, surface.vtu and surface.ply: the deformed surface, coloured by pressure.
  All are written together at the end, or none; files of those names are replaced. One run at a time has the folder.
  If it cannot be written any more, they go to a new one beside it or to the system's temporary folder, and the last
  line (`files` of --json) says where; if no folder takes them, the tables go to standard output.

Ctrl-C (or SIGTERM) ends the run at the best state so far, which is written together with checkpoint.nisp and without
error bars; the status is not_converged. If that takes more than 8 s, checkpoint.nisp alone is written. A second Ctrl-C
ends it at once.

Checkpoints (--checkpoint, Ctrl-C) hold the whole state of the solver. `nisp solve SCENE --resume DIR`, with the other
options as before, goes on as if the run had not stopped, to the last bit on the same kind of processor; --budget counts
from now, --iterations from the first start. A checkpoint that is damaged or of another problem is refused.

Exit codes:
  0  the answer passes all checks (status `converged`, or `budget` where the time was spent)
  2  bad input; nothing was written (--json: an object whose `status` is error, with the message as `error`)
  3  a check failed (status `inconsistent` or `budget`), not converged or interrupted (`not_converged`);
     the best state was written
  4  the results could not be written to the folder of --out, or to standard output";

/// Behind the short help of `eval`.
pub(crate) const EVAL_SEE_HELP: &str =
    "Exit codes: 0 read, 2 bad input, 3 the answer is not to be relied on, 4 not written. `--help` has examples.";

/// Behind the long help of `eval`.
pub(crate) const EVAL_TEACH: &str = "\
Examples:
  nisp eval nisp-out/answer.nisp --grid 500
      every field and source at 500 points over the domain
  nisp eval beam/answer.nisp --at gauges.csv --of 'w, M, d(M, x)' --out moments.csv
      deflection, bending moment (a `let M = ...;` of the equation) and shear force where the gauges are

An answer holds the text of its equation, parameters, scales, and what carries fields and sources with what is known of
it; no data are needed. --of takes the name of every `let` outside of groups and of every parameter; derivatives are
written as in equations. Fields, sources and parameters come in their declared units and everything else in SI units,
which stand in the headers.

An answer has values at places, and no integrals: sums of deviations would need how all places vary together. Over one
coordinate declare the integral as a field, `d(E, t) == P` with `E == 0` at the start: it has its own deviations.

A column NAME_sd holds the standard deviation, where the answer has any. Those of derivatives and expressions follow
from the same posterior, to first order.

The answer holds between the points that it was found from: in their range along each coordinate, and in their convex
hull over every two. Other points have no value, NaN (null in --json), and their number goes to standard error.

Exit codes:
  0  read
  2  bad input, or no point inside; nothing was written
  3  read, but the answer is not to be relied on: it did not converge or failed a check
  4  could not be written";
