# What pairing saves, of paired.csv. From this folder:
#   gnuplot paired.gnuplot
set terminal svg size 720,440 dynamic rounded font 'Helvetica,15' background '#ffffff'
set output 'paired.svg'
set datafile separator ','
set logscale xy
set xrange [7.4:54]
set yrange [0.00004:0.6]
set xtics (8, 12, 16, 20, 30, 50) nomirror
set ytics (0.0001, 0.001, 0.01, 0.1, 0.25) nomirror
set format y '%g'
set border 3 lc rgb '#555555'
set grid ytics lc rgb '#dddddd' lt 1
set xlabel 'poses measured'
set ylabel 'trials needed, paired / unpaired'
set title 'V against random poses on the same 150 robots'
set key left bottom samplen 2.5
of(robot, errors) = "< grep '^".robot.",".errors.",.*,v,' paired.csv"
plot 0.25 with lines lc rgb '#c0392b' lw 1 notitle, \
     of('fanuc_r2000ic_165f', 'geometric') using 3:6 with linespoints lc rgb '#7a3b9e' pt 4 dt 2 title 'FANUC, geometry', \
     of('fanuc_r2000ic_165f', 'full') using 3:6 with linespoints lc rgb '#7a3b9e' pt 5 lw 2 title 'FANUC, full model', \
     of('abb_irb120', 'geometric') using 3:6 with linespoints lc rgb '#1f6fb4' pt 6 dt 2 title 'IRB 120, geometry', \
     of('abb_irb120', 'full') using 3:6 with linespoints lc rgb '#1f6fb4' pt 7 lw 2 title 'IRB 120, full model', \
     of('ur10', 'geometric') using 3:6 with linespoints lc rgb '#2a9d5c' pt 10 dt 2 title 'UR10, geometry', \
     of('ur10', 'full') using 3:6 with linespoints lc rgb '#2a9d5c' pt 11 lw 2 title 'UR10, full model'
