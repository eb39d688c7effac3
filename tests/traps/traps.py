#!/usr/bin/env python3
"""Corrupts simulated campaigns of three robots in known ways and tells what the program says of each:
exit code, fit and held out (mm), the calibrated robot's true error at 100 noise-free poses with base and
targets refitted, its ratio to that of the clean campaign, and the warnings with their cures applied.
Too long for the tests: run it by hand.

  OMP_NUM_THREADS=1 python3 tests/traps/traps.py PROGRAM designs [--robots fanuc,irb,ur] [--only 'none|regex']
"""
import argparse, csv, io, json, math, os, random, re, subprocess, sys, tempfile

ENV = dict(os.environ, OMP_NUM_THREADS='1')
DESIGNS = None
RAD = math.pi / 180

def run(program, *args):
    r = subprocess.run([program, *args], capture_output=True, text=True, env=ENV)
    return r.returncode, r.stdout, r.stderr

class Table:
    def __init__(self, path=None):
        self.comments, self.rows = [], []
        if path is None: return
        lines = open(path).read().splitlines()
        self.comments = [l for l in lines if l.startswith('#')]
        body = [l for l in lines if not l.startswith('#')]
        self.head = body[0].split(',')
        self.rows = [l.split(',') for l in body[1:]]
    def copy(self):
        t = Table(); t.comments = list(self.comments); t.head = list(self.head)
        t.rows = [list(r) for r in self.rows]; return t
    def write(self, path):
        with open(path, 'w') as f:
            f.write('\n'.join([','.join(self.head)] + [','.join(r) for r in self.rows]) + '\n')
    def col(self, name): return self.head.index(name)
    @property
    def q(self): return [i for i, h in enumerate(self.head) if re.match(r'q\d_rad', h)]
    @property
    def p(self): return [i for i, h in enumerate(self.head) if re.search(r'_mm$', h)]
    @property
    def ids(self):
        seen = []
        for r in self.rows:
            if r[0] not in seen: seen.append(r[0])
        return seen

def g(x): return repr(float(x))
def add(r, i, d): r[i] = g(float(r[i]) + d)

# ---- the corruptions: each gets a fresh copy and changes it ----
def each(f):
    def change(t):
        ids = {c: k for k, c in enumerate(t.ids)}
        for r in t.rows: f(t, r, ids[r[0]], len(ids))
        return t
    return change
def scale_points(factor): return each(lambda t, r, k, n: [r.__setitem__(i, g(float(r[i]) * factor)) for i in t.p])
def axis(t, a): return [i for i in t.p if t.head[i].endswith(a + '_mm')]
def joint(j, f, when=lambda k, n: True):
    def one(t, r, k, n):
        if when(k, n): r[t.q[j - 1]] = g(f(float(r[t.q[j - 1]]), r, t))
    return each(one)
def swap_joints(a, b):
    def one(t, r, k, n):
        i, j = t.q[a - 1], t.q[b - 1]; r[i], r[j] = r[j], r[i]
    return each(one)
def swap_xyz(order, signs=(1, 1, 1)):
    def one(t, r, k, n):
        for a in range(0, len(t.p), 3):
            v = [float(r[i]) for i in t.p[a:a + 3]]
            for c in range(3): r[t.p[a + c]] = g(signs[c] * v[order[c]])
    return each(one)
def moved(mm, a='x'):
    return each(lambda t, r, k, n: [add(r, i, mm) for i in axis(t, a)] if k >= n // 2 else None)
def half(k, n): return k >= n // 2
def swap_targets(when):
    def one(t, r, k, n):
        if when(k, n):
            for c in range(3):
                i, j = t.p[c], t.p[3 + c]; r[i], r[j] = r[j], r[i]
    return each(one)
def rounded(deg): return each(lambda t, r, k, n: [r.__setitem__(i, g(round(float(r[i]) / RAD / deg) * deg * RAD)) for i in t.q])
def turned(mrad):
    def one(t, r, k, n):
        if k < n // 2: return
        for a in range(0, len(t.p), 3):
            i, j = t.p[a], t.p[a + 1]; x, y = float(r[i]), float(r[j])
            c, s = math.cos(mrad / 1e3), math.sin(mrad / 1e3)
            r[i], r[j] = g(c * x - s * y), g(s * x + c * y)
    return each(one)
def drift(mm): return each(lambda t, r, k, n: [add(r, i, mm * k / n) for i in axis(t, 'z')])
def growth(ppm): return each(lambda t, r, k, n: [r.__setitem__(i, g(float(r[i]) * (1 + ppm * 1e-6 * k / n))) for i in t.p])
def slipped(mm): return each(lambda t, r, k, n: add(r, t.p[0], mm) if half(k, n) else None)
def outliers(share, mm):
    def change(t):
        rnd = random.Random(5); width = 3
        points = [(r, t.p[a:a + 3]) for r in t.rows for a in range(0, len(t.p), width)]
        count = max(1, round(share * len(points)))
        for r, cols in rnd.sample(points, count):
            v = [rnd.gauss(0, 1) for _ in range(3)]; norm = math.sqrt(sum(x * x for x in v))
            for i, x in zip(cols, v): add(r, i, mm * x / norm)
        return t
    return change
def backlash(mrad):
    def change(t):
        i = t.q[1]; ids = t.ids; value = {}
        for r in t.rows: value[r[0]] = float(r[i])
        sign = {c: math.copysign(1, value[c] - value[ids[k - 1]]) if k else 1 for k, c in enumerate(ids)}
        for r in t.rows: add(r, i, -sign[r[0]] * mrad / 1e3)
        return t
    return change
def noise(mrad):
    def change(t):
        rnd = random.Random(6); off = {}
        for r in t.rows:
            o = off.setdefault(r[0], [rnd.gauss(0, mrad / 1e3) for _ in t.q])
            for i, d in zip(t.q, o): add(r, i, d)
        return t
    return change
def late(t):
    ids = t.ids; q = {}
    for r in t.rows: q.setdefault(r[0], [r[i] for i in t.q])
    for r in t.rows:
        k = ids.index(r[0])
        for i, v in zip(t.q, q[ids[max(0, k - 1)]]): r[i] = v
    return t
def exchanged(t):
    ids = t.ids; a, b = ids[3], ids[7]; q = {}
    for r in t.rows: q.setdefault(r[0], [r[i] for i in t.q])
    for r in t.rows:
        if r[0] in (a, b):
            for i, v in zip(t.q, q[b if r[0] == a else a]): r[i] = v
    return t
def stuck_target(t):
    first = [t.rows[0][i] for i in t.p[:3]]
    for r in t.rows:
        for i, v in zip(t.p[:3], first): r[i] = v
    return t
def stuck_joint(t):
    for r in t.rows: r[t.q[1]] = t.rows[0][t.q[1]]
    return t
def zero_reading(t):
    for r in t.rows:
        if r[0] == t.ids[6] and r[1] == '0':
            for i in t.p[:3]: r[i] = '0'
    return t
def shuffled(t):
    blocks = [[r for r in t.rows if r[0] == c] for c in t.ids]
    random.Random(4).shuffle(blocks); t.rows = [r for b in blocks for r in b]; return t
def round_mm(t):
    for r in t.rows:
        for i in t.p: r[i] = g(round(float(r[i])))
    return t
def twice(t):
    t.rows = [x for c in t.ids for r in [[y for y in t.rows if y[0] == c]] for x in r + [[y[0], str(int(y[1]) + len(r))] + y[2:] for y in r]]
    return t
def at(k0): return lambda k, n: k == k0

def traps(has_points):
    yield 'none (clean)', lambda t: t
    yield 'one joint (q3) in the other unit', joint(3, lambda v, r, t: v / RAD)
    yield 'points: m under mm', scale_points(1e-3)
    yield 'points: mm under m', scale_points(1e3)
    yield 'points: inch under mm', scale_points(1 / 25.4)
    yield 'q1 and q2 exchanged', swap_joints(1, 2)
    yield 'q4 and q6 exchanged', swap_joints(4, 6)
    yield 'q2 and q3 exchanged', swap_joints(2, 3)
    yield 'x and y exchanged (left-handed)', swap_xyz((1, 0, 2))
    yield 'z negated (left-handed)', swap_xyz((0, 1, 2), (1, 1, -1))
    yield 'x,y,z cycled (right-handed)', swap_xyz((1, 2, 0))
    if has_points:
        yield 'targets 1 and 2 exchanged everywhere', swap_targets(lambda k, n: True)
        yield 'targets 1 and 2 exchanged from half-way', swap_targets(half)
        yield 'targets 1 and 2 exchanged in one configuration', swap_targets(at(5))
    for j in range(1, 7): yield f'q{j} reversed', joint(j, lambda v, r, t: -v)
    yield 'q6 + 360 deg in half the rows', joint(6, lambda v, r, t: v + 2 * math.pi, half)
    yield 'q1 wrapped: 360 deg added where negative', joint(1, lambda v, r, t: v + 2 * math.pi if v < 0 else v)
    yield 'q2 + 90 deg everywhere (other zero)', joint(2, lambda v, r, t: v + math.pi / 2)
    yield 'q2 + 5 deg everywhere', joint(2, lambda v, r, t: v + 5 * RAD)
    yield 'q3 coupled: q3+q2 recorded (parallelogram)', joint(3, lambda v, r, t: v + float(r[t.q[1]]))
    yield 'q2 stuck at its first value', stuck_joint
    yield 'joints rounded to 0.1 deg', rounded(0.1)
    yield 'joints rounded to 1 deg', rounded(1)
    for d in (5, 0.5, 0.05): yield f'one configuration: q3 recorded {d} deg off', joint(3, lambda v, r, t, d=d: v + d * RAD, at(5))
    yield 'every row twice (new sample numbers)', twice
    yield 'rows shuffled (harmless)', shuffled
    yield 'joints one configuration late', late
    yield 'joints of two configurations exchanged', exchanged
    yield 'target 1 stuck: same reading everywhere', stuck_target
    yield 'one reading 0,0,0', zero_reading
    yield 'readings rounded to 1 mm', round_mm
    for mm in (10, 1, 0.2): yield f'tracker moved {mm} mm half-way', moved(mm)
    yield 'tracker turned 1 mrad half-way', turned(1)
    yield 'drift 0.5 mm in z over the campaign', drift(0.5)
    yield 'instrument scale + 1e-4', scale_points(1 + 1e-4)
    yield 'instrument scale + 1e-3', scale_points(1 + 1e-3)
    yield 'growth 50 ppm over the campaign', growth(50)
    yield 'target 1 slipped 5 mm half-way', slipped(5)
    for s in (1, 10, 30):
        yield f'outliers {s}%, 5 mm, squares', outliers(s / 100, 5)
        yield f'outliers {s}%, 5 mm, cauchy --loss cauchy', outliers(s / 100, 5)
    yield 'outliers 30%, 500 mm, cauchy --loss cauchy', outliers(0.3, 500)
    yield 'backlash q2 0.5 mrad, sign by the way there', backlash(0.5)
    yield 'backlash q2 5 mrad', backlash(5)
    yield 'joint noise 1 mrad in q1..q6', noise(1)

def longer(factor):
    def one(m): return m[1] + repr(float(m[2]) * factor) + m[3]
    return lambda text: re.sub(r'^(\s*- T[xyz] )(-?[\d.]+)( mm)', one, text, flags=re.M)
def richer(text):
    text = re.sub(r'\s*\[\w+\]$|\s*\[\w+\](?=\s*#)', '', text, flags=re.M) if 'errors:' not in text else text
    text = re.sub(r'^  errors: .*$', '  errors: full', text, flags=re.M)
    if 'errors: full' not in text: text = text.replace('robot:\n', 'robot:\n  errors: full\n', 1)
    return text
def other_truths():
    for f, t in ((1.1, '10 % larger'), (1.01, '1 % larger'), (1.001, '0.1 % larger (thermal)'), (1.00005, '50 ppm longer')):
        yield 'wrong robot: truth ' + t, longer(f)
    yield 'full model in truth only', richer

BASE_UR = 'base: {position_mm: [1500, 300, -400], rpy_deg: [0, 0, 120]}\n'
def campaigns(designs):
    text = open(f'{designs}/fanuc_r2000ic_165f/campaign.yaml').read()
    yield 'fanuc', text, 24
    text = open(f'{designs}/abb_irb120/planning.yaml').read().replace(
        '{count: 3}', '{position_mm: [[60, 40, 90], [-50, 60, 80], [20, -70, 100]]}')
    yield 'irb', text + 'base: {position_mm: [2500, 300, -400], rpy_deg: [0, 0, 120]}\n', 40
    text = open(f'{designs}/ur10/campaign.yaml').read()
    if not re.search(r'^base:', text, re.M): text += BASE_UR
    text = text.replace('  kind: poses\n', '  kind: poses\n  tool: {position_mm: [30, -20, 100], rpy_deg: [10, 20, 30]}\n')
    yield 'ur', text, 40

def noise_free(text):
    text = re.sub(r'(sigma\w*(mm|mrad|deg)):\s*[\d.e-]+', r'\1: 1e-6', text)
    text = re.sub(r'(model_error\w*):\s*[\d.e-]+', r'\1: 0', text)
    if 'model_error_mm' not in text: text += 'model_error_mm: 0\n'
    return text

def rms_of(d):
    if not d: return None
    for key in ('distance_rms_mm', 'rms_mm'):
        if key in d: return d[key]
    for v in d.values():
        if isinstance(v, dict):
            r = rms_of(v)
            if r is not None: return r
    return None

def judge(program, work, campaign, data, test, extra):
    args = ['calibrate', campaign, '-m', data, '--validate', test, '--refit', 'base,targets', '--json', *extra]
    rc, out, err = run(program, *args)
    warnings = err
    if rc == 3 or not out.strip():
        rc2, out, _ = run(program, *args, '--force')
    try: j = json.loads(out).get('accuracy', {})
    except Exception: j = {}
    return rc, warnings, j

def main():
    a = argparse.ArgumentParser()
    a.add_argument('program'); a.add_argument('designs')
    a.add_argument('--robots', default='fanuc,irb,ur'); a.add_argument('--only', default='')
    a.add_argument('--work', default=os.path.join(tempfile.gettempdir(), 'posewise_traps')); a.add_argument('--csv-only', action='store_true')
    a.add_argument('--full', action='store_true', help='print all of standard error')
    o = a.parse_args()
    o.program = os.path.realpath(o.program)
    for name, text, count in campaigns(os.path.realpath(o.designs)):
        if name not in o.robots.split(','): continue
        w = f'{o.work}/{name}'; os.makedirs(w, exist_ok=True)
        c = f'{w}/campaign.yaml'; open(c, 'w').write(text)
        c0 = f'{w}/noise_free.yaml'; open(c0, 'w').write(noise_free(text))
        rc, out, err = run(o.program, 'simulate', c, '--truth', '11', '--seed', '21', '--poses', str(count), '--repeats', '2', '--out', f'{w}/clean.csv')
        if rc: sys.exit(err)
        rc, out, err = run(o.program, 'simulate', c0, '--truth', '11', '--seed', '99', '--poses', '100', '--out', f'{w}/test.csv')
        if rc: sys.exit(err)
        clean = Table(f'{w}/clean.csv')
        true_clean = None
        rc, _, j = judge(o.program, w, c, f'{w}/test.csv', f'{w}/test.csv', ['--folds', '0'])
        nominal = rms_of(j.get('nominal'))
        print(f'=== {name}: nominal robot {nominal} mm at the clean poses')
        others = [(t, f) for t, f in other_truths()]
        for trap, change in [*traps(name != 'ur'), *others]:
            if o.only and not re.search(o.only, trap): continue
            path = f"{w}/{re.sub('[^a-z0-9.]+', '_', trap.lower())}.csv"
            if (trap, change) in others:
                other = f'{w}/truth.yaml'; open(other, 'w').write(change(text))
                rc, out, err = run(o.program, 'simulate', other, '--truth', '11', '--seed', '21', '--poses', str(count), '--repeats', '2', '--out', path)
                if rc: print('###', name, '|', trap, '| cannot be simulated:', err.strip()); continue
            else:
                change(clean.copy()).write(path)
            if o.csv_only: continue
            test = f'{w}/test.csv'
            extra = re.findall(r'--loss cauchy', trap) and ['--loss', 'cauchy'] or []
            rc, err, j = judge(o.program, w, c, path, test, extra)
            true = rms_of(j.get('validation'))
            if trap.startswith('none'): true_clean = true
            held = rms_of(j.get('held_out'))
            f = lambda x: '-' if x is None else f'{x:.4f}'
            ratio = f'{true / true_clean:.2f}' if true and true_clean else '-'
            print(f'### {name} | {trap} | rc {rc} | fit {f(rms_of(j.get("fit")))} held {f(held)} | true {f(true)} x{ratio} of clean, nominal {f(nominal)} | {"worse than nominal" if true and nominal and true > nominal else ""}', flush=True)
            for line in err.splitlines(): print('   ', line if o.full else line[:400].replace(w + '/', ''))
            for cure in dict.fromkeys(re.findall(r'with (--(?:exclude|loss|sizes|fix)[^:;]*?)(?::|;|,? [a-z]|$)', err)):
                rc2, err2, j2 = judge(o.program, w, c, path, test, extra + cure.split())
                t2 = rms_of(j2.get('validation'))
                print(f'    cure {cure}: rc {rc2} true {f(t2)} x{t2 / true_clean if t2 and true_clean else 0:.2f}', flush=True)
main()
