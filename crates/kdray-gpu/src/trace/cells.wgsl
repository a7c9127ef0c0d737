// Double precision, by steps that the parameters bring: `recipe.rs` lists them and says why.

//#import ray
//#import double_product

// Operations.
const SUB = 1u;
const MUL = 2u;
const DIV = 3u;

// Cells.
const ONE = 0u;
const MINUS_ONE = 1u;
const DIRECTION = 2u;
const ORIGIN = 5u;
const T_PER_Z = 8u;
const SHEAR = 9u;
const CORNERS = 11u;
const ENDS = 20u;
const EDGES = 24u;
const SHARE = 27u;
const DISTANCE = 28u;
const RESULT = 29u;
const CELLS = 33u;

// Parts of the list.
const SLOPES_END = 3u;
const POINTS_END = 24u;
const EDGE_END = 27u;
const WEIGHTS_END = 31u;
const NEAREST_END = 41u;
const FOOT_END = 49u;
const STEPS_END = 56u;

var<private> cells: array<Double, CELLS>;

fn run_steps(first: u32, end: u32) {
    for (var at = first; at < end; at++) {
        let step = params.steps[at >> 2u][at & 3u];
        let a = cells[(step >> 8u) & 0xffu];
        var b = cells[step & 0xffu];
        var result: Double;
        switch step >> 24u {
            case MUL: {
                result = d_mul(a, b);
            }
            case DIV: {
                result = d_div(a, b);
            }
            default: {
                b.sign ^= select(0u, F_SIGN, (step >> 24u) == SUB);
                result = d_add(a, b);
            }
        }
        cells[(step >> 16u) & 0xffu] = result;
    }
}

fn set_cell(cell: u32, bits: u32) {
    cells[cell] = d_of(bits);
}
