MODULE cell
  ! posewise, FANUC R-2000iC/165F in a cell
  LOCAL CONST speeddata slow:=[200,100,200,100];
  PROC cell_run()
    ! home
    MoveAbsJ [[0.0000,-30.0000,0.0000,0.0000,0.0000,0.0000],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,slow,fine,tool0;
    ! p1
    MoveAbsJ [[78.7864,16.9178,-61.6482,101.9218,-63.5326,28.3155],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,slow,fine,tool0;
    TPWrite "p1";
    WaitTime \InPos,2.0;
    Stop;
    ! via
    MoveAbsJ [[50.0000,0.0000,-20.0000,95.0000,-70.0000,60.0000],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,slow,fine,tool0;
    ! p2
    MoveAbsJ [[32.7249,-31.2371,-17.7869,91.8263,-81.6135,92.6331],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,slow,fine,tool0;
    TPWrite "p2";
    WaitTime \InPos,4.0;
    Stop;
    ! v1
    MoveAbsJ [[-10.9421,55.8517,42.5795,85.3322,-40.4909,148.2132],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,slow,fine,tool0;
    TPWrite "v1";
    WaitTime \InPos,2.0;
    Stop;
    ! home
    MoveAbsJ [[0.0000,-30.0000,0.0000,0.0000,0.0000,0.0000],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,slow,fine,tool0;
  ENDPROC
ENDMODULE
