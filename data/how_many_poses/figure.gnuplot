# Accuracy against number of poses: robots that were drawn, and real ones. From this folder:
#   gnuplot figure.gnuplot
set terminal svg size 1100,480 dynamic rounded font 'Helvetica,15' background '#ffffff'
set output 'figure.svg'
set multiplot layout 1,2 margins 0.07,0.985,0.13,0.91 spacing 0.06
set logscale xy
set xrange [7.4:54]
set xtics (8, 12, 16, 20, 30, 50) nomirror
set ytics (0.05, 0.1, 0.2, 0.5, 1, 2) nomirror
set border 3 lc rgb '#555555'
set grid ytics lc rgb '#dddddd' lt 1
set xlabel 'poses measured'
set ylabel 'position error, RMS / mm'

# What a line of the table of one error model has: random, V and D in columns 3, 4 and 8.
of(model) = "< grep 'errors=".model." ' abb_irb120.txt | grep '^ *[0-9]'"
set title 'ABB IRB 120, 150 robots drawn, judged on fresh poses'
set yrange [0.17:1]
set key at graph 0.99,0.57 right samplen 2.5 spacing 1.05
plot of('geometric') using 1:3 with linespoints lc rgb '#b0b0b0' pt 6 dt 2 title 'random, geometry', \
     of('geometric') using 1:8 with linespoints lc rgb '#e08a1e' pt 4 dt 2 title 'D, geometry', \
     of('geometric') using 1:4 with linespoints lc rgb '#1f6fb4' pt 8 dt 2 title 'V, geometry', \
     of('full') using 1:3 with linespoints lc rgb '#808080' pt 7 lw 2 title 'random, full model', \
     of('full') using 1:8 with linespoints lc rgb '#e08a1e' pt 5 lw 2 title 'D, full model', \
     of('full') using 1:4 with linespoints lc rgb '#1f6fb4' pt 9 lw 2 title 'V, full model'

found(name) = "< grep '^".name.",' real_robots.csv"
set datafile separator ','
set title 'Real robots, judged on poses held out (full model)'
set yrange [0.06:2.6]
unset ylabel
set key at graph 0.99,0.99 right samplen 3
set label 1 'Motoman MA1400' at 20.5,0.86 tc rgb '#7a3b9e'
set label 2 'KUKA iiwa 7' at 20.5,0.345 tc rgb '#c0392b'
set label 3 'UR10' at 8.3,0.43 tc rgb '#2a9d5c'
set label 4 'ABB IRB 120' at 8.3,0.117 tc rgb '#1f6fb4'
set label 5 'Meca500' at 21.5,0.072 tc rgb '#444444'
plot found('Motoman MA1400') using 2:5 with lines lc rgb '#7a3b9e' dt 3 notitle, \
     '' using 2:3 with linespoints lc rgb '#7a3b9e' pt 5 lw 2 notitle, \
     found('KUKA iiwa 7') using 2:5 with lines lc rgb '#c0392b' dt 3 notitle, \
     '' using 2:3 with linespoints lc rgb '#c0392b' pt 9 lw 2 notitle, \
     found('UR10') using 2:5 with lines lc rgb '#2a9d5c' dt 3 notitle, \
     '' using 2:3 with linespoints lc rgb '#2a9d5c' pt 11 lw 2 notitle, \
     found('ABB IRB 120') using 2:5 with lines lc rgb '#1f6fb4' dt 3 notitle, \
     '' using 2:3 with linespoints lc rgb '#1f6fb4' pt 7 lw 2 notitle, \
     found('Meca500') using 2:5 with lines lc rgb '#444444' dt 3 notitle, \
     '' using 2:3 with linespoints lc rgb '#444444' pt 13 lw 2 notitle, \
     NaN with lines lc rgb '#555555' dt 3 title 'random', \
     NaN with linespoints lc rgb '#555555' pt 7 lw 2 title 'V-optimal'
unset multiplot
