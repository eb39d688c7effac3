MODULE cell
  PROC weld()
    MoveL [[1650.0,-200.0,820.0],[0.5,0.5,-0.5,0.5],[0,-1,0,1],[9E9,9E9,9E9,9E9,9E9,9E9]],v100,fine,torch\WObj:=table;
  ENDPROC
ENDMODULE
