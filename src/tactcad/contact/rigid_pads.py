"""Many presses of rigid pads on one layer: each pad as three numbers, its force and two moments.

A pad alone obeys one law, tabulated once for a layer: forces follow from its depth and its inclination to the
face, with contact lost where it lifts. Because the body is linear, that law is homogeneous (twice the depth
and slopes, twice the force) and proportional to the modulus, so it is tabulated over two ratios. Between
pads, forces and moments move and incline each other's part of the face by a matrix, exact where whole pads
touch. A pad lifted on one side presses, and feels its neighbours, with the rest of its area only: `lifted`
gives the change from the moments of its pressure up to the fourth, and from what the others' pressure changes
in these. `press` solves every patch instead; the tests compare the two.

`press_many` presses hundreds of pads once: what two pads do to each other is found as if no other were there,
so that only 3 x 3 numbers a pair are kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import inf

import numpy as np
from scipy.interpolate import RectBivariateSpline

from tactcad.design.messages import CheckFailure

from .elastic_body import Body, influence, mean_inverse
from .press import Pads, Pressed, complementary, patches

KNOTS = 41  # of each ratio in the table, 0 to 1; with 21 a layer's fit errs up to three times as much
ROUNDS = 60  # of Newton's method, at most
COARSE = 6  # patches a side of a pad for what pads do to each other
DEGREE = 4  # order of a pad's moments felt by its neighbours; 2 errs up to 0.4 % where it lifts
POWERS = np.array([(a, k - a) for k in range(DEGREE + 1) for a in range(k, -1, -1)])  # of x and y
SECOND = slice(3, 6)  # of POWERS: x^2, x y, y^2
POINTS = 1e-4  # a pad that touches in so small a share of itself cannot bear a moment
LOADED = 1e-9  # relative error of the load of `press_many`
STRAYED = 1e-6  # of the largest depth: left of the equations when they count as not solved
STRAYS = 40  # times that it may; some three ways of bisection
CLOSE = 1e-8  # of the largest depth: left of the equations when they count as solved

# values and slopes at both ends of a unit cell to the coefficients of a cubic
HERMITE = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [-3, 3, -2, -1], [2, -2, 1, 1]])


@dataclass(frozen=True)
class PadLaw:
    """Force and moments of one pad on a layer of 1 MPa; `cells` are a bicubic's coefficients. `felt` are the
    moments of the pressure by POWERS for each unit of force and moments (mm), its `spread`; beside the second
    ones, what these lose, at the same force and moments, where the face curves by them, its `relief`."""

    length: float
    width: float
    cells: np.ndarray  # [4, 4, 3, cell]
    felt: np.ndarray  # [knot, knot, power, 6]

    def _place(self, r: np.ndarray) -> tuple[np.ndarray, ...]:
        """Size, the two ratios, their signs, and which pads touch."""
        side = np.array([self.length, self.width])
        sign = np.where(r[..., 1:] < 0, -1.0, 1.0)
        fall = np.abs(r[..., 1:]) * side  # across the whole pad
        deepest = r[..., 0] + fall.sum(-1) / 2
        size = np.maximum(deepest, 0.0) + fall.sum(-1)
        size = np.where(size > 0, size, 1.0)
        touches = deepest > 0
        return size, np.where(touches[..., None], fall / size[..., None], 0.0), sign, touches

    def moments(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """`spread` and `relief` of pads at r, [..., power, 3] and [..., 3, 3]."""
        _, ratio, sign, touches = self._place(r)
        cell, u = _cell(ratio)
        u = u[..., None, None]
        i, j, of = cell[..., 0], cell[..., 1], self.felt
        low = (1 - u[..., 0, :, :]) * of[i, j] + u[..., 0, :, :] * of[i + 1, j]
        high = (1 - u[..., 0, :, :]) * of[i, j + 1] + u[..., 0, :, :] * of[i + 1, j + 1]
        found = (1 - u[..., 1, :, :]) * low + u[..., 1, :, :] * high
        odd = (sign[..., None, :] ** POWERS).prod(-1)
        turn = np.concatenate([np.ones_like(sign[..., :1]), sign, odd[..., SECOND] * touches[..., None]], -1)
        found = found * odd[..., None] * turn[..., None, :]
        return found[..., :3], found[..., SECOND, 3:]

    def __call__(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force (N) and moments (N mm) for each MPa, and their derivatives.

        Parameters
        ----------
        r : ndarray, [..., 3]
            Depth of the pad's middle in the face, mm, and by how much the depth grows along x and y.

        Returns
        -------
        ndarray, [..., 3], and ndarray, [..., 3, 3]
        """
        size, ratio, sign, touches = self._place(r)
        cell, place = _cell(ratio)
        u, v = np.moveaxis(place, -1, 0)
        c = self.cells.take(cell[..., 0] * (KNOTS - 1) + cell[..., 1], -1)
        along = ((c[:, 3] * v + c[:, 2]) * v + c[:, 1]) * v + c[:, 0]
        across = (3 * c[:, 3] * v + 2 * c[:, 2]) * v + c[:, 1]
        f = ((along[3] * u + along[2]) * u + along[1]) * u + along[0]
        by_first = (3 * along[3] * u + 2 * along[2]) * u + along[1]
        by_second = ((across[3] * u + across[2]) * u + across[1]) * u + across[0]
        # forces = size f(fall/size); by depth, and by each fall, of which size has 3/2 more
        by = np.stack([f, by_first, by_second], 1)  # [force, by what, ...]
        by[:, 1:] *= KNOTS - 1
        by[:, 0] -= by[:, 1] * ratio[..., 0] + by[:, 2] * ratio[..., 1]
        by[:, 1:] += 1.5 * by[:, :1]
        turn = np.ones((3, *size.shape))
        turn[1:] = np.moveaxis(sign * (self.length, self.width), -1, 0)
        forces = f * turn * (size * touches)
        derivative = by * turn[:, None] * (turn * touches)
        derivative = np.ascontiguousarray(np.moveaxis(derivative, (0, 1), (-2, -1)))
        return np.ascontiguousarray(np.moveaxis(forces, 0, -1)), derivative


def _cell(ratio: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The cell between knots of each ratio, and the place in it; NaN, as an endless tilt has it, is in the
    first."""
    at = ratio * (KNOTS - 1)
    cell = np.clip(at.astype(int), 0, KNOTS - 2)
    return cell, at - cell


@lru_cache(maxsize=64)  # 1.8 MB each
def pad_law(poisson: float, thickness: float, base: str, length: float, width: float) -> PadLaw:
    """The law of one rectangular pad, by solving its patches at every knot."""
    one = patches(length, width, False)
    M = influence(Body(1.0, poisson, thickness, base), tuple(one))
    M = (M + M.T) / 2
    modes = np.stack([np.ones(one.shape[1]), one[0] / length, one[1] / width])
    t = np.linspace(0, 1, KNOTS)
    value = np.zeros((3, KNOTS, KNOTS))
    basis = _powers(one[0], one[1])
    felt = np.zeros((KNOTS, KNOTS, len(basis), 6))
    by_contact: dict[bytes, np.ndarray] = {}  # neighbouring knots touch with the same patches
    for i, x in enumerate(t):
        f = np.ones(one.shape[1])
        for j, y in enumerate(t[: KNOTS - i]):
            depth = 1 - 1.5 * (x + y)
            f, _ = complementary(M, -(x * modes[1] + y * modes[2]), None, depth, np.ones(one.shape[1]), f > 0)
            value[:, i, j] = modes @ f
            if not f.any():  # a corner that just touches: as before it
                felt[i, j] = felt[i, j - 1] if j else felt[i - 1, j]
                continue
            touching = np.flatnonzero(f)
            if (key := touching.tobytes()) not in by_contact:
                by_contact[key] = _felt(M, np.concatenate([modes, basis]), touching, length, width)
            felt[i, j] = by_contact[key]
        felt[i, KNOTS - i :] = felt[i, KNOTS - i - 1]
    step = 1 / (KNOTS - 1)
    cells = np.empty((4, 4, 3, (KNOTS - 1) ** 2))
    for k, of in enumerate(value):
        spline = RectBivariateSpline(t, t, of)
        data = np.array([[spline(t, t, dx=a, dy=b) * step ** (a + b) for b in (0, 1)] for a in (0, 1)])
        both = [
            data[a, b, p : KNOTS - 1 + p, q : KNOTS - 1 + q]
            for a in (0, 1)
            for p in (0, 1)
            for b in (0, 1)
            for q in (0, 1)
        ]
        corner = np.array(both).reshape(4, 4, KNOTS - 1, KNOTS - 1)
        cells[:, :, k] = np.einsum("ia,abxy,jb->ijxy", HERMITE, corner, HERMITE).reshape(4, 4, -1)
    return PadLaw(length, width, cells, felt)


def _felt(M: np.ndarray, shapes: np.ndarray, touching: np.ndarray, length: float, width: float) -> np.ndarray:
    """`felt` of a pad that touches with these patches, [power, 6]; `shapes`: three modes, then powers."""
    found = np.zeros((len(shapes) - 3, 6))
    seen = shapes[:, touching]
    grip = seen @ np.linalg.solve(M.take(touching, 0).take(touching, 1), seen.T)
    rigid, way = np.linalg.eigh(grip[:3, :3])
    held = rigid > POINTS * rigid[-1]
    way = way[:, held]
    inverse = (way / rigid[held]) @ way.T
    found[:, :3] = grip[3:, :3] @ inverse / (1.0, length, width)
    relief = grip[3:, 3:] - grip[3:, :3] @ inverse @ grip[:3, 3:]
    found[SECOND, 3:] = relief[SECOND, SECOND]
    return found


def _powers(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """x^a y^b, [power, ...]."""
    return np.array([x**a * y**b for a, b in POWERS])


def _apart(at: np.ndarray) -> dict[tuple[int, int], np.ndarray]:
    """Where one pad lies from another, once for all pairs alike, by the same in whole nm."""
    return {_nm(at[i] - at[j]): at[i] - at[j] for i in range(len(at)) for j in range(i + 1)}


def _nm(apart: np.ndarray) -> tuple[int, int]:
    return round(apart[0] * 1e6), round(apart[1] * 1e6)


@lru_cache(maxsize=2)
def _mean_inverses(x: bytes, y: bytes, length: float, width: float) -> list[np.ndarray]:
    """Mean inverses common to every layer under these pads: for each of `_apart`, [patch, patch]."""
    at = np.stack([np.frombuffer(x), np.frombuffer(y)], -1)
    one = patches(length, width, False, COARSE)
    return [mean_inverse((one[0] + dx, one[1] + dy, *one[2:]), tuple(one)) for dx, dy in _apart(at).values()]


@lru_cache(maxsize=512)  # some 0.1 MB each
def between(
    x: bytes, y: bytes, length: float, width: float, poisson: float, thickness: float, base: str
) -> tuple[np.ndarray, np.ndarray]:
    """Depth and slopes of the face under every pad for force and moments on every other one, for 1 MPa,
    [3 pad, 3 pad]; and the sink of the face about each pad, as a polynomial by POWERS, by the moments of the
    pressure on the others, [pad, power, pad, power]. x and y are the bytes of the pads' middles."""
    at = np.stack([np.frombuffer(x), np.frombuffer(y)], -1)
    one, n = patches(length, width, False, COARSE), len(at)
    m = one.shape[1]
    modes = np.stack([np.ones(m), one[0], one[1]])
    unit = Body(1.0, poisson, thickness, base)
    face = np.empty((n, m, n, m))
    blocks = {
        nm: influence(unit, (one[0] + dx, one[1] + dy, *one[2:]), tuple(one), mean)
        for (nm, (dx, dy)), mean in zip(_apart(at).items(), _mean_inverses(x, y, length, width))
    }
    for i in range(n):
        for j in range(i + 1):
            block = blocks[_nm(at[i] - at[j])]
            face[i, :, j], face[j, :, i] = block, block.T
    full = np.linalg.inv(face.reshape(n * m, n * m)).reshape(n, m, n, m)
    grip = np.einsum("am,imjk,bk->iajb", modes, full, modes).reshape(3 * n, 3 * n)
    out = np.linalg.inv(grip).reshape(n, 3, n, 3)
    area = (one[2] * one[3]) ** 0.5
    near = np.linalg.pinv((_powers(one[0], one[1]) * area).T) * area
    field = np.einsum("pm,imjk,qk->ipjq", near, face, near, optimize=True)
    # a pad's own part is its law's, but for what its neighbours hold
    field[np.arange(n), :, np.arange(n)] = 0.0
    out[np.arange(n), :, np.arange(n)] -= np.linalg.inv(modes @ np.linalg.inv(face[0, :, 0]) @ modes.T)
    return out.reshape(3 * n, 3 * n), field


class ManyPresses:
    """Pads that each give way in one manner (a hinge) on one layer, set up once.

    x, y, length, width, move: middles, sides (mm), and sink and slopes of each pad as its middle sinks by 1,
    [pad, 3]; a pad's spring sees the force and moments that do work in that motion.
    """

    def __init__(
        self,
        x: np.ndarray,
        y: np.ndarray,
        length: float,
        width: float,
        move: np.ndarray,
        body: Body,
        others: np.ndarray | None = None,
    ) -> None:
        """`others` replaces `between`; `lifted` is not known then."""
        self.x, self.y, self.move, self.body = x, y, move, body
        self.law = pad_law(body.poisson, body.thickness, body.base, length, width)
        at = x.tobytes(), y.tobytes(), length, width, body.poisson, body.thickness, body.base
        if others is not None:
            self.between = others
            return
        self.between, self.field = between(*at)
        self.whole = np.zeros(())
        self.whole = self.lifted(np.tile([1.0, 0.0, 0.0], (len(x), 1)))

    def lifted(self, r: np.ndarray) -> np.ndarray:
        """Change, for pads at depths r, of their effects on each other's depth, [..., 3 pad, 3 pad]."""
        n, m = len(self.x), len(POWERS)
        own, relief = self.law.moments(r)
        by = self.field.reshape(n * m, n, m).swapaxes(0, 1) @ own  # [..., loaded pad, pad and power, 3]
        by = by.swapaxes(-3, -2).reshape(*r.shape[:-2], n, m, 3 * n)
        felt = (own.swapaxes(-1, -2) @ by).reshape(*r.shape[:-2], 3 * n, 3 * n)
        # pads whose face is curved by others press otherwise, and are felt so
        curved = by[..., SECOND, :]
        back = (relief @ curved).reshape(felt.shape)
        return felt - curved.reshape(felt.shape).swapaxes(-1, -2) @ back - self.whole

    def system(
        self, modulus: np.ndarray, stiffness: np.ndarray, lifted: np.ndarray | None = None
    ) -> np.ndarray:
        """Depth lost for each unit of the law's forces, [..., 3 pad, 3 pad].

        Parameters
        ----------
        modulus : ndarray, [...]
            MPa.
        stiffness : ndarray, [..., pad]
            Of the springs, N/mm.
        lifted : ndarray, [..., 3 pad, 3 pad]
            As `lifted` tells of pads near those that are asked for.
        """
        n = len(self.x)
        own = self.move[:, :, None] * self.move[:, None, :]
        spring = (modulus[..., None] / stiffness)[..., None, None] * own
        M = np.broadcast_to(self.between, (*modulus.shape, 3 * n, 3 * n)).copy()
        if lifted is not None:
            M += lifted
        for i in range(n):
            M[..., 3 * i : 3 * i + 3, 3 * i : 3 * i + 3] += spring[..., i, :, :]
        return M

    def approached(self, approach: np.ndarray, slope: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Depth of rigid pads in an undisturbed face, [..., pad, 3]: approach [...], slopes of the face
        [..., 2] and heights [..., pad] as in `press`."""
        b = np.empty((*height.shape, 3))
        b[..., 0] = approach[..., None] - height - slope[..., :1] * self.x - slope[..., 1:] * self.y
        b[..., 1:] = -slope[..., None, :]
        return b

    def rest(self, M: np.ndarray, b: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, ...]:
        """Depths that leave the pads at rest, the law's forces there, its derivatives, and the matrix J of
        `pressing`, by Newton's method: depth + M law(depth) = b. What already rests is left out."""
        shape, n3 = b.shape, 3 * b.shape[-2]
        M, b, r = M.reshape(-1, n3, n3), b.reshape(-1, n3 // 3, 3), start.reshape(-1, n3 // 3, 3).copy()

        def state(M: np.ndarray, b: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, ...]:
            g, d = self.law(depth)
            off = b - depth - (M @ g.reshape(-1, n3, 1)).reshape(depth.shape)
            return g, d, off, (off**2).sum((-1, -2))

        todo = np.arange(len(r))
        g, d, off, size = state(M, b, r)
        close = (CLOSE * np.abs(b).max((-1, -2), initial=1e-9)) ** 2
        for _ in range(ROUNDS):
            todo = todo[size[todo] > close[todo]]
            if not len(todo):
                break
            M_, b_, r_, d_, off_, size_ = (a[todo] for a in (M, b, r, d, off, size))
            more = np.linalg.solve(pressing(M_, d_), (d_ @ off_[..., None]).reshape(-1, n3, 1))
            step, share = off_ - (M_ @ more).reshape(r_.shape), np.ones(len(todo))
            for _ in range(12):
                depth = r_ + share[:, None, None] * step
                tried = state(M_, b_, depth)
                worse = tried[3] > size_
                if not worse.any():
                    break
                share = np.where(worse, share / 2, share)
            for old, now in zip((r, g, d, off, size), (depth, *tried)):
                old[todo] = now
        J = pressing(M, d).reshape(*shape[:-2], n3, n3)
        return r.reshape(shape), g.reshape(shape), d.reshape(*shape, 3), J

    def near(self, M: np.ndarray, b: np.ndarray, r: np.ndarray) -> np.ndarray:
        """The law's forces at rest, of a body that hardly differs from one with the pads at rest at depths
        r.
        """
        g, d = self.law(r)
        off = b - r - (M @ g.reshape(*M.shape[:-1], 1)).reshape(r.shape)
        right = (d @ off[..., None]).reshape(*M.shape[:-1], 1)
        return g + np.linalg.solve(pressing(M, d), right).reshape(r.shape)


def pressing(M: np.ndarray, d: np.ndarray) -> np.ndarray:
    """J, [..., 3 pad, 3 pad]: where depths in the undisturbed face grow by db, forces of pads at rest grow by
    J^-1 d db; d are the derivatives of the law's forces, pad by pad."""
    n = d.shape[-3]
    J = d @ M.reshape(*M.shape[:-2], n, 3, 3 * n)
    J.reshape(*M.shape[:-2], -1)[..., :: 3 * n + 1] += 1.0
    return J.reshape(M.shape)


def press_many(pads: Pads, body: Body, load: float, angle: tuple[float, float]) -> Pressed:
    """As `PadsOnBody.press` by a load, for rectangular pads each on one hinge, any number of them.

    Memory goes with the square of the pads' number, 72 MB for a thousand: every pad moves every other one.
    Raises CheckFailure if no rest is found: inclined pads on a body thousands of times stiffer than their
    springs, of which corners touch.
    """
    n, K = len(pads.x), 1 / pads.compliance[:, 0, 0]
    move = pads.compliance[:, :, 0] * K[:, None]
    slope = np.tan(np.radians(angle))
    at = ManyPresses(pads.x, pads.y, pads.length, pads.width, move, body, _between_two(pads, body))
    E = body.modulus
    back = pads.height + pads.x * slope[0] + pads.y * slope[1]
    alone = at.law(np.array([1.0, 0.0, 0.0]))[0][0] * E
    each = 1 / (1 / alone + 1 / K)
    first = float(back.min() - np.abs(slope) @ (pads.length, pads.width) / 2)  # a corner touches
    ready = np.argsort(back)
    reach = (load + np.cumsum((each * back)[ready])) / np.cumsum(each[ready])
    approach = float(reach[np.maximum((reach > back[ready]).sum() - 1, 0)])
    stopped, depth = np.zeros(n, bool), at.approached(np.array(approach), slope, pads.height)
    strays = 0
    for _ in range(4 * n + 4):
        fixed = np.where(stopped, pads.stop, 0.0)[:, None] * move
        M = at.system(np.array(E), np.where(stopped, inf, K))
        low, high, solved = first, inf, first
        while True:
            b = at.approached(np.array(approach), slope, pads.height) - fixed
            found, g, d, J = at.rest(M, b, depth)
            left = b - found - (M @ g.reshape(-1)).reshape(b.shape)
            if np.abs(left).max() > STRAYED * np.abs(b).max():  # Newton's method: half of the way is easier
                strays += 1
                if strays > STRAYS or approach == solved:
                    raise CheckFailure(
                        f"the law of whole pads finds no rest of {n} pads on {E:g} MPa at {angle[0]:g} and "
                        f"{angle[1]:g} degrees: press them softer, or less inclined"
                    )
                approach = (approach + solved) / 2
                continue
            depth, solved = found, approach
            off = load - E * g[:, 0].sum()
            if abs(off) < LOADED * load:
                break
            low, high = (approach, high) if off > 0 else (low, approach)
            steep = E * np.linalg.solve(J, d[..., 0].reshape(-1))[::3].sum()
            step = approach + off / steep if steep > 0 else inf
            if not low < step < high:  # bisect if the tangent leaves the bracket
                step = (low + high) / 2 if high < inf else 2 * approach - low + load / alone
            if step == approach:
                break
            approach = float(step)
        carried = E * np.einsum("ni,ni->n", g, move)  # by the spring, and the stop
        sink = np.where(stopped, pads.stop, carried / K)
        beyond = ~stopped & (sink > pads.stop * (1 + 1e-12))
        free = stopped & (carried < pads.stop * K)
        if not beyond.any() and not free.any():
            break
        stopped = (stopped | beyond) & ~free
    one, M1 = _alone(body, pads.length, pads.width)
    m = one.shape[1]
    patch = np.empty((5, n, m))
    for i in range(n):
        gap = -(depth[i, 1] * one[0] + depth[i, 2] * one[1])
        f, _ = complementary(M1, gap, None, depth[i, 0], np.ones(m))
        patch[:, i] = pads.x[i] + one[0], pads.y[i] + one[1], one[2], one[3], E * f
    area = one[2] * one[3]
    contact = (area * (patch[4] > 0)).sum(1) / area.sum()
    return Pressed(approach, E * g[:, 0], sink, sink[:, None] * move[:, 1:], contact, stopped, patch)


def _alone(body: Body, length: float, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Patches of one pad, and their influence on each other for 1 MPa."""
    one = patches(length, width, False)
    M = influence(Body(1.0, body.poisson, body.thickness, body.base), tuple(one))
    return one, (M + M.T) / 2


def _between_two(pads: Pads, body: Body) -> np.ndarray:
    """As the first of `between`, every pair of pads as if no other were there; equal distances once."""
    n = len(pads.x)
    apart = np.stack([pads.x - pads.x[:, None], pads.y - pads.y[:, None]], axis=-1).reshape(-1, 2)
    places, which = np.unique(np.round(apart, 9), axis=0, return_inverse=True)
    size = pads.length, pads.width, body.poisson, body.thickness, body.base
    blocks = np.array(
        [
            between(np.array([0.0, dx]).tobytes(), np.array([0.0, dy]).tobytes(), *size)[0][:3, 3:]
            if dx or dy
            else np.zeros((3, 3))
            for dx, dy in places
        ]
    )
    return blocks[which.ravel()].reshape(n, n, 3, 3).swapaxes(1, 2).reshape(3 * n, 3 * n)
