"""Golden numbers of tests/core/random_test.cpp, from the definitions, independent of the C++ code:
SplitMix64 [Steele, Lea, Flood 2014] seeds mt19937_64 [Matsumoto, Nishimura 2004], whose upper 53
bits make a uniform number.    usage: random_stream.py
"""

MASK = (1 << 64) - 1


def mix(x):
    x = (x + 0x9E3779B97F4A7C15) & MASK
    x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & MASK
    return x ^ (x >> 31)


def mt19937_64(seed):
    n, m = 312, 156
    state = [seed]
    for i in range(1, n):
        state.append((6364136223846793005 * (state[-1] ^ (state[-1] >> 62)) + i) & MASK)
    upper, lower = MASK ^ (2**31 - 1), 2**31 - 1
    while True:
        for i in range(n):
            x = (state[i] & upper) | (state[(i + 1) % n] & lower)
            state[i] = state[(i + m) % n] ^ (x >> 1) ^ (0xB5026F5AA96619E9 if x & 1 else 0)
        for x in state:
            x ^= (x >> 29) & 0x5555555555555555
            x ^= (x << 17) & 0x71D67FFFEDA60000
            x ^= (x << 37) & 0xFFF7EEE000000000
            yield x ^ (x >> 43)


def stream(seed, item):
    return mt19937_64(mix((mix(seed) + item) & MASK))


if __name__ == "__main__":
    default = mt19937_64(5489)  # the C++ standard fixes the 10000th number
    assert [next(default) for _ in range(10000)][-1] == 9981545732273789042
    for seed, item in [(1, 0), (1, 1), (2, 0)]:
        numbers = stream(seed, item)
        print(seed, item, [(next(numbers) >> 11) * 2.0**-53 for _ in range(3)])
